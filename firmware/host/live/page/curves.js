// SPDX-License-Identifier: Apache-2.0
// The plots of the page, and how often they are drawn.
import { ERROR, TICK } from "./model.js";
import { Strip } from "./strip.js";

const { el, fixed } = Fovea;
const DRAW_MS = 120;
const SPANS = [5, 10, 20, 60];

const px = (v) => (v < 100 ? `${v.toFixed(2)} px` : `${Math.round(v)} px`);

function stripsOf(model) {
  const of = (name) => () => model[name];
  const joints = model.setup.joints;
  const perJoint = (column) =>
    joints.map((joint, i) => ({
      name: `joint ${i + 1}`,
      tag: String(i + 1),
      colour: `--joint-${i + 1}`,
      rows: of("ticks"),
      column: column + i,
      width: 1.5,
    }));
  const axes = (names, column) =>
    names.map((name, i) => ({
      name,
      colour: ["--vermillion", "--green", "--blue"][i],
      dash: [[], [7, 3], [2, 2]][i],
      rows: of("ticks"),
      column: column + i,
    }));
  const limits = [
    { value: 100, text: "limit" },
    { value: -100, text: "limit" },
  ];
  const percent = (v) => `${fixed(v, 0)} %`;
  const idealRows = () => (model.truth.size ? model.errors : model.measured);
  const eye = [
    {
      id: "error",
      label: "image error [px]",
      log: true,
      format: px,
      series: [
        { name: "measured", colour: "--vermillion", rows: of("measured"), column: ERROR.size, dots: true },
        { name: "true", colour: "--blue", rows: of("errors"), column: ERROR.size, width: 2 },
        { name: "ideal", colour: "--ink", rows: idealRows, column: ERROR.ideal, dash: [6, 4], width: 1.4 },
      ],
    },
  ];
  return [
    ...(model.setup.target ? eye : []),
    {
      id: "v",
      label: "commanded velocity v of the camera [m/s]",
      least: 0.02,
      series: axes(["v x", "v y", "v z"], TICK.v),
    },
    {
      id: "omega",
      label: "commanded turn rate ω of the camera [rad/s]",
      least: 0.05,
      series: axes(["ω x", "ω y", "ω z"], TICK.omega),
    },
    {
      id: "joints",
      label: "joint positions [% of the limit]",
      range: [-112, 112],
      lines: limits,
      format: percent,
      series: perJoint(TICK.q),
    },
    {
      id: "torques",
      label: "torques without gravity [% of the limit]",
      least: 20,
      lines: limits,
      format: percent,
      series: perJoint(TICK.tau),
    },
    {
      id: "age",
      label: "age of the measurement [ms]",
      least: 50,
      format: (v) => `${v.toFixed(0)} ms`,
      series: [{ name: "age", colour: "--blue", rows: of("ticks"), column: TICK.age_ms }],
    },
    {
      id: "ticks",
      label: "time of a tick [µs]",
      least: 10,
      format: (v) => `${v.toFixed(1)} µs`,
      series: [
        { name: "median", colour: "--blue", rows: of("tickTimes"), column: 0 },
        { name: "greatest", colour: "--vermillion", rows: of("tickTimes"), column: 1, dash: [6, 3] },
      ],
    },
  ];
}

export class Curves {
  #strips = [];
  #drawn = 0;
  #last = "";

  // The first plot is drawn into `lead`, the others into `host`.
  constructor(lead, host, model, moment) {
    Object.assign(this, { lead, model, moment });
    this.span = 10;
    this.grid = el("div", { class: "strips" });
    this.modes = el("ul", { class: "mode-legend" });
    host.append(
      el(
        "div",
        { class: "toolbar" },
        Fovea.choice(
          "Seconds that the plots show",
          SPANS.map((s) => [s, `${s} s`]),
          this.span,
          (s) => (this.span = s),
        ),
        this.modes,
      ),
      this.grid,
    );
    this.modes.append(
      el("li", { class: "mode-legend-head", text: "Shading:" }),
      ...Object.keys(Fovea.MODES).map((mode) =>
        el(
          "li",
          { title: Fovea.MODES[mode].words },
          el("i", { class: `mode-swatch ${mode}` }),
          el("span", { text: mode }),
        ),
      ),
    );
  }

  // Makes the plots when the setup is known.
  build() {
    this.#strips = stripsOf(this.model).map((options) => new Strip(this.model, options));
    const [first, ...others] = this.#strips.map((strip) => strip.node);
    this.lead.replaceChildren(first);
    this.grid.replaceChildren(...others);
  }

  // Called at each picture of the screen; draws when it is time.
  draw(now) {
    const { model, moment } = this;
    if (now - this.#drawn < DRAW_MS || !this.#strips.length) return;
    const t = moment.t;
    const to = moment.isLive ? t : Math.min(model.now, t + this.span / 2);
    const key = `${t} ${to} ${this.span} ${moment.isLive}`;
    // A paused run has nothing new; the theme or the size may have changed, so it is drawn once a second.
    if (key === this.#last && now - this.#drawn < 1000) return;
    this.#last = key;
    this.#drawn = now;
    this.grid.closest("section").hidden = !model.hasServo;
    for (const strip of this.#strips) {
      const { id } = strip.options;
      const empty = (id === "ticks" && !model.tickTimes.size) || (id !== "error" && !model.hasServo);
      if (strip.node.hidden !== empty) strip.node.hidden = empty;
      if (!empty) strip.draw(to - this.span, to, moment.isLive ? null : t);
    }
    this.lead.closest("section").hidden = this.#strips[0].node.hidden;
  }
}
