// SPDX-License-Identifier: Apache-2.0
// The bar that is always in sight: pause, single step, speed, and the last minute to look back at.
import { KEPT_S } from "./history.js";

const { el, plain } = Fovea;
const SPEEDS = [
  [0.1, "0.1 ×"],
  [0.25, "0.25 ×"],
  [0.5, "0.5 ×"],
  [1, "1 × real time"],
  [0, "as fast as it goes"],
];
const WAYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }; // keys of the slider
const ago = (seconds) => `${seconds < 9.95 ? seconds.toFixed(1) : Math.round(seconds)} s ago`;

export class Transport {
  constructor(host, actions, model, moment) {
    Object.assign(this, { actions, model, moment });
    this.pause = el("button", { type: "button", class: "pause", onclick: () => this.#pause() });
    this.step = el("button", {
      type: "button",
      text: "Step",
      title: "One tick, 1 ms. With Shift: 20 ticks.",
      onclick: (event) => this.#step(event),
    });
    this.speed = el(
      "select",
      { "aria-label": "Speed of the simulation", onchange: () => this.#speed() },
      SPEEDS.map(([value, words]) => el("option", { value, text: words })),
    );
    this.other = el("option", { hidden: true }); // a speed that another client chose
    this.speed.append(this.other);
    this.slider = el("input", {
      type: "range",
      class: "scrub",
      min: -KEPT_S,
      max: 0,
      step: 0.02,
      value: 0,
      "aria-label": "Look back at the last 60 seconds",
      oninput: () => this.#scrub(),
      onkeydown: (event) => this.#scrubKey(event),
    });
    this.zero = 0; // [s]: the run time at the slider's right end
    this.sliding = false; // the slider stays where the hand holds it
    this.slider.addEventListener("pointerdown", () => (this.sliding = true));
    for (const end of ["pointerup", "pointercancel"]) this.slider.addEventListener(end, () => (this.sliding = false));
    this.when = el("output", { class: "when" });
    this.live = el("button", {
      type: "button",
      class: "to-live",
      text: "Back to live",
      onclick: () => moment.goLive(),
    });
    host.append(
      el("div", { class: "transport-run" }, this.pause, this.step, this.speed),
      el("div", { class: "transport-past" }, this.slider, this.when, this.live),
    );
    model.listen((what) => (what === "state" || what === "reset") && this.show());
    moment.listen(() => this.show());
    actions.connection.listen(() => this.show());
    this.show();
  }

  show() {
    const { actions, model, moment } = this;
    const { state } = model;
    const paused = !!state?.paused;
    this.pause.textContent = paused ? "▶ Run" : "❚❚ Pause";
    this.pause.disabled = !actions.may("/run/pause");
    this.step.disabled = !actions.may("/run/step") || !paused;
    this.speed.disabled = !actions.may("/run/speed");
    const { connection } = actions;
    for (const [node, service] of [
      [this.pause, "/run/pause"],
      [this.step, "/run/step"],
      [this.speed, "/run/speed"],
    ])
      node.hidden = connection.state === "open" && !connection.has(service);
    if (state && document.activeElement !== this.speed) {
      const near = SPEEDS.find(([value]) => Math.abs(value - state.speed) < 1e-6);
      this.other.hidden = !!near;
      if (!near && this.other.value !== String(state.speed)) {
        this.other.value = state.speed;
        this.other.textContent = `${plain(state.speed, 3)} ×`;
      }
      this.speed.value = near ? near[0] : state.speed;
    }
    if (moment.isLive || !this.sliding) {
      this.zero = model.now;
      this.slider.value = moment.t - model.now;
    }
    const words = moment.isLive
      ? `${model.now.toFixed(2)} s`
      : `${moment.t.toFixed(2)} s, ${ago(model.now - moment.t)}`;
    if (this.when.textContent !== words) this.when.textContent = words;
    this.live.disabled = moment.isLive;
    this.live.textContent = moment.isLive ? "Live" : "Back to live";
    document.documentElement.classList.toggle("past", !moment.isLive);
  }

  #pause() {
    this.actions.call("/run/pause", { paused: !this.model.state?.paused });
  }

  #step(event) {
    this.moment.goLive();
    this.actions.call("/run/step", { ticks: event.shiftKey ? 20 : 1 });
  }

  async #speed() {
    const wanted = Number(this.speed.value);
    this.speed.blur();
    if (!(await this.actions.call("/run/speed", { factor: wanted }))) this.show();
  }

  #scrub() {
    const back = Number(this.slider.value);
    if (back > -0.03) this.moment.goLive();
    else this.moment.lookAt(this.zero + back);
  }

  #scrubKey(event) {
    const way = WAYS[event.key];
    if (!way || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const t = this.moment.t + way * (event.shiftKey ? 1 : 0.1);
    if (t < this.model.now) this.moment.lookAt(t);
    else this.moment.goLive();
  }
}
