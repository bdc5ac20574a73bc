// SPDX-License-Identifier: Apache-2.0
// The small tools that every script of a page uses: elements, tables, numbers as text. The first script of a page.
"use strict";

const Fovea = {};

// An element: el('p', {class: 'x', text: 'words'}, child, child). Text is only ever inserted as text.
Fovea.el = function (tag, attributes, ...children) {
  return Fovea.fill(document.createElement(tag), attributes, children);
};

Fovea.svg = function (tag, attributes, ...children) {
  return Fovea.fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
};

Fovea.fill = function (node, attributes, children) {
  for (const [key, value] of Object.entries(attributes || {})) {
    if (value === null || value === undefined || value === false) continue;
    if (key === "text") node.textContent = value;
    else if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else node.setAttribute(key, value === true ? "" : String(value));
  }
  for (const child of children.flat()) if (child !== null && child !== undefined) node.append(child);
  return node;
};

// A table with a line of `heads` over `rows`, which are lists of cells or {class, cells}. A head or a cell is text, a node,
// a list of both, or {class, of: one of these}. `number`: whether column i holds numbers. `named`: the first cell of a
// row is its heading. `scroll`: it may be wider than the page. More attributes are the table's.
Fovea.table = function (heads, rows, { caption, number, named = true, scroll = false, ...attributes } = {}) {
  const { el } = Fovea;
  const cell = (tag, scope, value, i) => {
    const { class: own, of } = value && value.of !== undefined ? value : { of: value };
    const names = [number && number(i) ? "number" : null, own].filter(Boolean);
    return el(tag, { class: names.join(" ") || null, scope }, [of].flat());
  };
  const line = (row) =>
    el(
      "tr",
      { class: row.class },
      (row.cells || row).map((value, i) =>
        named && i === 0 ? cell("th", "row", value, i) : cell("td", null, value, i),
      ),
    );
  const top = heads.map((value, i) => cell("th", "col", value, i));
  const table = el(
    "table",
    attributes,
    caption ? el("caption", { text: caption }) : null,
    el("thead", {}, el("tr", {}, top)),
    el("tbody", {}, rows.map(line)),
  );
  return scroll ? el("div", { class: "scroll" }, table) : table;
};

Fovea.absent = (words) => Fovea.el("p", { class: "absent", text: words });

// A number as text with about `digits` significant digits, never in scientific notation.
Fovea.number = function (value, digits = 3) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size === 0) return "0";
  const decimals = Math.max(0, Math.min(6, digits - 1 - Math.floor(Math.log10(size))));
  const text = value.toFixed(decimals);
  return (/^-0\.?0*$/.test(text) ? text.slice(1) : text).replace("-", "−");
};

// A given number, such as a limit, without trailing zeros: 2.175, 87.
Fovea.plain = (value, digits = 4) =>
  Number.isFinite(value) ? String(parseFloat(value.toPrecision(digits))).replace("-", "−") : "–";

Fovea.fixed = function (value, decimals) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  const text = value.toFixed(decimals);
  return (/^-0\.?0*$/.test(text) ? text.slice(1) : text).replace("-", "−");
};

Fovea.words = (key) => String(key === null || key === undefined ? "" : key).replace(/_/g, " ");

Fovea.plural = (count, one, many) => `${count} ${count === 1 ? one : many || one + "s"}`;

// Index of the last entry with times[i] <= t, or -1.
Fovea.indexAt = function (times, t) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle + 1;
    else high = middle;
  }
  return low - 1;
};

// A row of buttons; one of them is pressed.
Fovea.choice = function (label, options, chosen, onChoose) {
  const buttons = options.map(([key, words]) =>
    Fovea.el("button", {
      type: "button",
      "aria-pressed": String(key === chosen),
      text: words,
      onclick: () => {
        buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(options[i][0] === key)));
        onChoose(key);
      },
    }),
  );
  return Fovea.el("div", { class: "choice", role: "group", "aria-label": label }, buttons);
};

// Callbacks that are called together. `listen` returns a function that removes its callback.
Fovea.callbacks = function () {
  const callbacks = new Set();
  return {
    listen(callback) {
      callbacks.add(callback);
      return () => callbacks.delete(callback);
    },
    tell: (...what) => callbacks.forEach((callback) => callback(...what)),
  };
};
