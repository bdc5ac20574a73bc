# SPDX-License-Identifier: Apache-2.0
"""Reads the figures of tools/results from what a program prints, and compares them with written ones."""

import json
import math
import operator
import re

# {name}, {name/1000:.2f}, {name*100:.0f}, {name/other:.1f}, {name - other:.1f}
FIELD = re.compile(r"\{([^{}:*/ ]+)(?:( - |[*/])([^{}:*/ ]+))?(?::([^{}]+))?\}")
COMBINE = {"*": operator.mul, "/": operator.truediv, " - ": operator.sub}
NUMBER = re.compile(r"(?<![\w.])-?\d[\d ]*(?:\.\d+)?(?:e[+-]?\d+)?")


class NoFigure(Exception):
    """An output does not have the figure of a row. The text says which."""


def finite(name, value):
    """The value, unless it is infinite or not a number."""
    if isinstance(value, float) and not math.isfinite(value):
        raise NoFigure(f"the figure {name} is {value}")
    return value


def flatten(value, name=""):
    """The numbers and texts of a JSON value, by dotted names. A list of figures (fovea-bench) is read by their names."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from flatten(inner, f"{name}.{key}" if name else key)
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            if isinstance(inner, dict) and {"name", "value"} <= inner.keys():
                yield inner["name"], inner["value"]
                yield inner["name"] + ".goal", inner.get("goal")
            else:
                yield from flatten(inner, f"{name}.{number}" if name else str(number))
    else:
        yield name, value


def find(patterns, output):
    """The named groups of regular expressions, searched in the printed text. A group max_NAME is the largest of all."""
    values = {}
    for pattern in patterns:
        matches = list(re.finditer(pattern, output, re.MULTILINE))
        if not matches:
            raise NoFigure(f"the output has no match of '{pattern}'")
        for name in matches[0].groupdict():
            numbers = [finite(name, float(match[name]) if re.search(r"[.en]", match[name]) else int(match[name]))
                       for match in matches]
            values[name] = max(numbers) if name.startswith("max_") else numbers[0]
    return values


def values_of(row, output):
    if not output.strip():
        raise NoFigure("the command printed nothing")
    if "find" in row:
        return find(row["find"], output)
    try:
        return dict(flatten(json.loads(output)))
    except json.JSONDecodeError as error:
        raise NoFigure("the output is not JSON") from error


def fill(template, values):
    """The template with each {field} replaced by its value. A format of ',' groups digits by spaces."""
    def number_of(name):
        if re.fullmatch(r"\d[\d.e]*", name):
            return float(name)
        if values.get(name) is None:
            raise NoFigure(f"the output has no figure {name}")
        return finite(name, values[name])

    def text_of(match):
        name, sign, other, form = match.groups()
        value = number_of(name)
        if sign is not None:
            value = finite(match[0], COMBINE[sign](value, number_of(other)))
        if form == ",":
            return f"{round(value):,}".replace(",", " ") if abs(value) >= 10000 else str(round(value))
        return format(value, form or "")
    return FIELD.sub(text_of, template)


def agree(new, old):
    """Whether two figures have the same text and the same numbers, up to one in the last digit."""
    if NUMBER.sub("#", new) != NUMBER.sub("#", old):
        return False
    for a, b in zip(NUMBER.findall(new), NUMBER.findall(old), strict=True):
        a, b = a.replace(" ", ""), b.replace(" ", "")
        digits = len(a.partition("e")[0].partition(".")[2])
        step = 10.0 ** (int(a.partition("e")[2] or 0) - digits)
        if abs(float(a) - float(b)) > 1.001 * step:
            return False
    return True
