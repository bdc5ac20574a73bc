// SPDX-License-Identifier: Apache-2.0
// Reads the embedded runs, and has the small tools that every other file uses.
"use strict";

const Fovea = {};

// base64 of little-endian float32 to a typed array; null stays null.
Fovea.floats = function (text) {
  if (typeof text !== "string") return null;
  const bytes = Fovea.bytes(text);
  return new Float32Array(bytes.buffer, 0, Math.floor(bytes.length / 4));
};

Fovea.bytes = function (text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
};

Fovea.readRuns = function () {
  const letters = "ABCDEFGH";
  return Array.from(document.querySelectorAll("script.fovea-run")).map((node, index) => {
    const run = JSON.parse(node.textContent);
    run.letter = letters[index];
    run.index = index;
    Fovea.decode(run);
    return run;
  });
};

// Turns the encoded arrays into typed arrays, and absent parts into empty ones.
Fovea.decode = function (run) {
  const list = (value) => (Array.isArray(value) ? value : []);
  const ticks = run.ticks || {};
  run.ticks = {};
  for (const key of ["t_s", "error_px", "error_mm", "predicted_px", "path_error_mm"])
    run.ticks[key] = Fovea.floats(ticks[key]);
  for (const key of ["q", "dq", "tau", "tau_meas", "twist_cmd", "twist_meas", "e"])
    run.ticks[key] = list(ticks[key]).map(Fovea.floats);
  const measured = run.measured || {};
  run.measured = {};
  for (const key of ["t_s", "error_px", "age_ms", "confidence"]) run.measured[key] = Fovea.floats(measured[key]);
  if (run.theory) for (const key of ["t_s", "x", "goal", "analytic"]) run.theory[key] = Fovea.floats(run.theory[key]);
  if (run.feature_path)
    for (const key of ["goal_px", "t_s", "px"]) run.feature_path[key] = Fovea.floats(run.feature_path[key]);
  for (const key of ["modes", "faults", "tunings", "limits_active", "joints", "error_components", "lost", "not_found"])
    run[key] = list(run[key]);
  run.info = run.info || {};
  run.has_eye = !!run.target;
  run.target = run.target || {};
  if (!Number.isFinite(run.duration_s)) {
    const last = (times) => (times && times.length ? times[times.length - 1] : 0);
    run.duration_s = Math.max(last(run.ticks.t_s), last(run.measured.t_s)) || 0;
  }
  if (run.scene) {
    for (const key of ["t_s", "poses", "camera_path", "target_path", "target_turn"])
      run.scene[key] = Fovea.floats(run.scene[key]);
  }
};

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

// The value of a series at time t: that of the row nearest to it, NaN when none is within `reach` seconds.
Fovea.valueAt = function (times, values, t, reach) {
  let index = Fovea.indexAt(times, t);
  if (index + 1 < times.length && (index < 0 || times[index + 1] - t < t - times[index])) index++;
  return index >= 0 && Math.abs(times[index] - t) <= reach ? values[index] : NaN;
};

// The number of frames in `spans`.
Fovea.frameCount = (spans) => spans.reduce((sum, span) => sum + span.frames, 0);

// The name of the target; null for a run without a camera.
Fovea.targetWord = (run) =>
  run.has_eye ? { sphere: "ball", circle: "disc" }[run.target.kind] || Fovea.words(run.target.kind) : null;

// The value of a key of the configuration, as text; null when it is not there.
Fovea.setting = function (run, key) {
  const [section, name] = key.split(".");
  let here = false;
  for (const line of String(run.config || "").split("\n")) {
    if (line.startsWith("[")) here = line === `[${section}]`;
    else if (here && line.startsWith(`${name} = `)) return line.slice(name.length + 3);
  }
  return null;
};

Fovea.hasNumbers = (values) => !!values && values.some(Number.isFinite);

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

Fovea.drawn = (id) => {
  document.getElementById(id).dataset.drawn = "true";
};
