// SPDX-License-Identifier: Apache-2.0
// A plot that scrolls: curves of the last seconds on a canvas, over the shading of the servo's modes.
import { CPU_CANVAS } from "./canvas.js";
import { MODES, TICK } from "./model.js";

const { el, theme, number, swatch } = Fovea;
const LEFT = 44;
const RIGHT = 26;
const BOTTOM = 18;
const TOP = 4;
const LEAST_LOG = 0.05;
const text = (value) => String(parseFloat(value.toPrecision(4))).replace("-", "−");

// Round values between low and high, about `count` of them.
function marks(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((one) => one * power >= raw) * power;
  const list = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step)
    list.push(Math.abs(v) < 1e-9 * step ? 0 : v);
  return list;
}

function decades(low, high) {
  const list = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high) + 1e-9; power++)
    for (const one of high / low > 300 ? [1] : [1, 2, 5])
      if (one * 10 ** power >= low && one * 10 ** power <= high) list.push(one * 10 ** power);
  return list;
}

export class Strip {
  #visible;
  #range = null;
  #outputs = [];

  // options: {id, label, series: [{name, colour, rows(), column, dash, dots, tag, width}], log, range, least (of the
  // upper end), lines: [{value, text}], format}
  constructor(model, options) {
    this.model = model;
    this.options = { format: (v) => number(v, 3), lines: [], ...options };
    this.seen = true;
    this.#visible = options.series.map(() => true);
    this.canvas = el("canvas", { class: "strip-canvas", role: "img", "aria-label": options.label });
    this.now = el("span", { class: "now" });
    this.area = el("div", { class: "strip-area" }, this.canvas);
    this.node = el(
      "figure",
      { class: "plot strip", id: `plot-${options.id}` },
      el("figcaption", {}, el("span", { class: "plot-label", text: options.label }), this.now),
      this.area,
      this.#legend(),
    );
    new IntersectionObserver((list) => (this.seen = list[list.length - 1].isIntersecting), {
      rootMargin: "80px",
    }).observe(this.node);
    new ResizeObserver(() => this.#resize()).observe(this.area);
  }

  #legend() {
    const { series } = this.options;
    return el(
      "ul",
      { class: "legend" },
      series.map((s, i) => {
        const value = el("span", { class: "legend-value" });
        this.#outputs.push(value);
        const button = el(
          "button",
          { type: "button", "aria-pressed": "true", title: "show or hide" },
          swatch(s),
          el("span", { text: s.name }),
          value,
        );
        button.addEventListener("click", () => {
          this.#visible[i] = !this.#visible[i];
          button.setAttribute("aria-pressed", String(this.#visible[i]));
        });
        return el("li", {}, button);
      }),
    );
  }

  #resize() {
    const ratio = Math.min(2, devicePixelRatio || 1);
    this.width = this.area.clientWidth;
    this.height = this.area.clientHeight;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.ratio = ratio;
  }

  // Draws the span [from, to] of time; a line marks `at` unless it is null.
  draw(from, to, at) {
    if (!this.seen || !this.width) return;
    const ctx = this.canvas.getContext("2d", CPU_CANVAS);
    ctx.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    ctx.clearRect(0, 0, this.width, this.height);
    const box = { x: LEFT, y: TOP, w: this.width - LEFT - RIGHT, h: this.height - TOP - BOTTOM };
    const xOf = (t) => box.x + ((t - from) / (to - from)) * box.w;
    const [low, high] = this.#rangeOf(from, to);
    const place = this.options.log
      ? (v) => Math.log(Math.max(v, low) / low) / Math.log(high / low)
      : (v) => (v - low) / (high - low);
    const yOf = (v) => box.y + box.h * (1 - place(v));
    this.#axes(ctx, box, from, to, low, high, xOf, yOf);
    ctx.save();
    ctx.beginPath();
    ctx.rect(box.x, box.y, box.w, box.h);
    ctx.clip();
    this.#modes(ctx, box, from, to, xOf);
    for (const line of this.options.lines) this.#line(ctx, box, yOf(line.value), line);
    const ends = [];
    this.options.series.forEach((s, i) => {
      if (this.#visible[i]) this.#curve(ctx, s, from, to, xOf, yOf, ends, box);
    });
    if (at !== null) this.#cursor(ctx, box, xOf(at));
    ctx.restore();
    tags(ctx, box, ends);
    this.#values(at === null ? to : at);
  }

  #rangeOf(from, to) {
    const { range, log, least = 0, series } = this.options;
    if (range) return range;
    let low = Infinity;
    let high = -Infinity;
    series.forEach((s, i) => {
      const rows = this.#visible[i] && s.rows();
      if (!rows) return;
      for (let row = Math.max(rows.begin, rows.at(from)); row < rows.end && rows.t[row] <= to; row++) {
        const v = rows.get(row, s.column);
        if (v < low && (!log || v > 0)) low = v;
        if (v > high && v < Infinity) high = v;
      }
    });
    if (log) {
      low = Math.max(LEAST_LOG, 10 ** Math.floor(Math.log10(low)));
      high = Math.max(10 * low, 10 ** Math.ceil(Math.log10(high) + 1e-9));
    } else {
      low = Math.min(0, low);
      high = Math.max(0, high);
      const span = Math.max(high - low, least);
      if (low < 0) [low, high] = [Math.min(low, -least / 2), Math.max(high, least / 2)];
      low -= low < 0 ? 0.08 * span : 0;
      high = Math.max(high, low + least) + 0.08 * span;
    }
    if (!(high > low)) return log ? [0.1, 100] : [0, 1];
    // The axis widens at once, and narrows only when the curves use less than half of it.
    const old = this.#range;
    const inside = old && low >= old[0] && high <= old[1];
    const size = ([a, b]) => (log ? Math.log(b / a) : b - a);
    if (!inside || size([low, high]) < 0.5 * size(old)) this.#range = [low, high];
    return this.#range;
  }

  #axes(ctx, box, from, to, low, high, xOf, yOf) {
    ctx.font = "12px system-ui, sans-serif";
    ctx.lineWidth = 1;
    ctx.strokeStyle = theme.colour("--grid");
    ctx.fillStyle = theme.colour("--quiet");
    ctx.beginPath();
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    for (const v of this.options.log ? decades(low, high) : marks(low, high, Math.max(2, box.h / 38))) {
      const y = Math.round(yOf(v)) + 0.5;
      if (y < box.y || y > box.y + box.h + 1) continue;
      ctx.moveTo(box.x, y);
      ctx.lineTo(box.x + box.w, y);
      ctx.fillText(text(v), box.x - 6, Math.max(box.y + 6, y));
    }
    ctx.textAlign = "center";
    ctx.textBaseline = "top";
    for (const t of marks(from, to, Math.max(2, box.w / 80))) {
      if (t < 0) continue;
      const x = Math.round(xOf(t)) + 0.5;
      ctx.moveTo(x, box.y);
      ctx.lineTo(x, box.y + box.h);
      if (x > box.x + 8) ctx.fillText(`${text(t)} s`, x, box.y + box.h + 4);
    }
    ctx.stroke();
    ctx.strokeStyle = theme.colour("--axis");
    ctx.strokeRect(box.x - 0.5, box.y, 0, box.h);
    ctx.strokeRect(box.x, box.y + box.h + 0.5, box.w, 0);
  }

  #modes(ctx, box, from, to, xOf) {
    const rows = this.model.ticks;
    if (!rows.size) return;
    let row = Math.max(rows.begin, rows.at(from));
    while (row < rows.end && rows.t[row] <= to) {
      const mode = rows.get(row, TICK.mode);
      let next = row + 1;
      while (next < rows.end && rows.get(next, TICK.mode) === mode) next++;
      const known = Fovea.MODES[(MODES[mode] || "").toLowerCase()];
      ctx.globalAlpha = MODES[mode] === "FAULT" ? 0.12 : 0.2;
      ctx.fillStyle = theme.colour(known ? known.colour : "--axis");
      const x = Math.max(box.x, xOf(rows.t[row]));
      ctx.fillRect(x, box.y, Math.min(box.x + box.w, xOf(next < rows.end ? rows.t[next] : to)) - x, box.h);
      row = next;
    }
    ctx.globalAlpha = 1;
  }

  #line(ctx, box, y, line) {
    ctx.strokeStyle = ctx.fillStyle = theme.colour("--alarm");
    ctx.setLineDash([2, 3]);
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(box.x, y);
    ctx.lineTo(box.x + box.w, y);
    ctx.stroke();
    ctx.setLineDash([]);
    if (!line.text) return;
    ctx.textAlign = "left";
    ctx.textBaseline = line.value < 0 ? "bottom" : "top";
    ctx.font = "11px system-ui, sans-serif";
    ctx.fillText(line.text, box.x + 5, y + (line.value < 0 ? -2 : 3));
  }

  // At most two points for each pixel: the least and the greatest value in it.
  #curve(ctx, s, from, to, xOf, yOf, ends, box) {
    const rows = s.rows();
    if (!rows || !rows.size) return;
    ctx.strokeStyle = ctx.fillStyle = theme.colour(s.colour);
    ctx.lineWidth = s.width || 1.6;
    ctx.setLineDash(s.dash || []);
    ctx.beginPath();
    let open = false;
    let last = null;
    const first = Math.max(rows.begin, rows.at(from));
    const gap = 0.5;
    let column = -1;
    let low = 0;
    let high = 0;
    const flush = () => {
      if (column < 0) return;
      if (!open) ctx.moveTo(column, low);
      open = true;
      ctx.lineTo(column, low);
      if (high !== low) ctx.lineTo(column, high);
      column = -1;
    };
    for (let row = first; row < rows.end && rows.t[row] <= to; row++) {
      const v = rows.get(row, s.column);
      const broken = !Number.isFinite(v) || (row > first && rows.t[row] - rows.t[row - 1] > gap);
      if (broken) {
        flush();
        open = false;
      }
      if (!Number.isFinite(v)) continue;
      const x = xOf(rows.t[row]);
      const y = yOf(v);
      last = y;
      if (s.dots) {
        ctx.moveTo(x + 1.7, y);
        ctx.arc(x, y, 1.7, 0, 7);
        continue;
      }
      const here = Math.round(x * 2) / 2;
      if (here !== column) {
        flush();
        column = here;
        low = high = y;
      } else {
        low = Math.min(low, y);
        high = Math.max(high, y);
      }
    }
    flush();
    if (s.dots) ctx.fill();
    else ctx.stroke();
    ctx.setLineDash([]);
    if (s.tag && last !== null) ends.push({ y: Math.min(box.y + box.h, Math.max(box.y, last)), s });
  }

  #cursor(ctx, box, x) {
    ctx.strokeStyle = theme.colour("--ink");
    ctx.lineWidth = 1.5;
    ctx.globalAlpha = 0.75;
    ctx.beginPath();
    ctx.moveTo(x, box.y);
    ctx.lineTo(x, box.y + box.h);
    ctx.stroke();
    ctx.globalAlpha = 1;
  }

  #values(t) {
    this.options.series.forEach((s, i) => {
      const rows = s.rows();
      const row = rows ? rows.at(t) : -1;
      const known = rows && row >= rows.begin && t - rows.t[row] < 1;
      const words =
        known && Number.isFinite(rows.get(row, s.column)) ? this.options.format(rows.get(row, s.column)) : "–";
      if (this.#outputs[i].textContent !== words) this.#outputs[i].textContent = words;
    });
  }
}

// The numbers of joints at the right ends of their curves, pushed apart.
function tags(ctx, box, ends) {
  ends.sort((a, b) => a.y - b.y);
  for (let i = 1; i < ends.length; i++) ends[i].y = Math.max(ends[i].y, ends[i - 1].y + 11);
  const over = ends.length ? ends[ends.length - 1].y - (box.y + box.h) : 0;
  ctx.font = "700 11px system-ui, sans-serif";
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  for (const { y, s } of ends) {
    ctx.fillStyle = theme.colour(s.colour);
    ctx.fillRect(box.x + box.w + 3, y - Math.max(0, over) - 5, 4, 10);
    ctx.fillText(s.tag, box.x + box.w + 10, y - Math.max(0, over));
  }
}
