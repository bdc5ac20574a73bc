#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs Spin on the model of a queue between two threads: Spin checks every order of the steps.

  check.py MODEL.pml SOURCE             the text that the model quotes must be in SOURCE, and no assertion may fail
  check.py MODEL.pml SOURCE MISTAKE     an assertion must fail with MISTAKE, which is an #ifdef of the model

Exit code 0 when this is so, otherwise 1.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def stripped(text):
    """C++ without comments and white space."""
    return re.sub(r"\s+", "", re.sub(r"//[^\n]*", "", text))


def quotes_of(model):
    """Text that the model quotes from each function: its comments that begin with a colon."""
    functions = []
    for quote in re.findall(r"/\*:(.*?)\*/", model, flags=re.DOTALL):
        if functions == [] or functions[-1].count("{") == functions[-1].count("}"):
            functions.append("")
        functions[-1] += stripped(quote)
    return functions


def run(*command, folder):
    answer = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return answer.returncode, answer.stdout + answer.stderr


def main():
    model, source, mistakes = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), sys.argv[3:]
    if shutil.which("spin") is None:
        print("spin is not installed: run tools/install test")
        return 1
    code = stripped(source.read_text())
    functions = quotes_of(model.read_text())
    for function in functions or ["the model quotes nothing"]:
        if function not in code or function.count("{") != function.count("}"):
            print(f"{model.name}: quoted text is not in {source.name}: {function}")
            return 1
    with tempfile.TemporaryDirectory() as folder:
        for command in (["spin", "-a", *("-D" + mistake for mistake in mistakes), str(model)],
                        ["cc", "-O1", "-DSAFETY", "-o", "pan", "pan.c"]):
            status, said = run(*command, folder=folder)
            if status != 0 or "error" in said.lower():
                print(said)
                return 1
        _, said = run("./pan", "-m100000", folder=folder)
    found = re.search(r"pan:\d+: (.*?)(?: \(at depth|$)", said, flags=re.MULTILINE)
    complete = re.search(r"State-vector .* errors: (\d+)", said) and "max search depth too small" not in said
    if not complete:
        print(said)
        return 1
    states = re.search(r"(\d+) states, stored", said)
    print(f"{model.name} {' '.join(mistakes)}: {states[1]} states, {found[1] if found else 'all assertions hold'}")
    if mistakes:
        return 0 if found and found[1].startswith("assertion violated") else 1
    unreached = re.findall(r"unreached in proctype.*?\n(.*?)\(\d+ of \d+ states\)", said, flags=re.DOTALL)
    if found or any(part.strip() for part in unreached):
        print(said)  # a step that is never taken proves nothing
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
