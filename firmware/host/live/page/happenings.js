// SPDX-License-Identifier: Apache-2.0
// What happened, line by line, and the limits that act at the shown moment.
import { TICK } from "./model.js";

const { el, words } = Fovea;
const MOST_LINES = 12;
const LEVELS = { WARNING: "warn", ERROR: "bad", FATAL: "bad" };

export class Happenings {
  constructor(host, model, moment) {
    Object.assign(this, { host, model, moment });
    this.limits = el("p", { class: "limits-now" });
    this.list = el("ol", { class: "happenings" });
    host.append(this.limits, this.list);
    model.listen((what) => {
      if (what === "event" || what === "reset") this.#show();
      if (what === "state") this.#showLimits();
    });
    this.#show();
  }

  #show() {
    const lines = this.model.events.slice(-MOST_LINES).reverse();
    this.list.replaceChildren(
      ...lines.map(({ t, level, message }) =>
        el(
          "li",
          { class: LEVELS[level] || null },
          el(
            "button",
            { type: "button", class: "at", title: "Look at this moment", onclick: () => this.moment.lookAt(t) },
            `${t.toFixed(2)} s`,
          ),
          el("span", { text: words(message) }),
        ),
      ),
    );
    if (!lines.length) this.list.append(el("li", { class: "note", text: "Nothing yet." }));
  }

  #showLimits() {
    const { model, moment } = this;
    this.host.closest("section").hidden = !model.hasServo;
    const row = model.ticks.rowAt(moment.t, 1);
    const bits = row ? row[TICK.limits] : 0;
    const names = (model.setup?.limits || []).filter((name, i) => (bits >> i) & 1).map(words);
    const text = names.length ? `Limits that act: ${names.join(", ")}.` : "No limit acts.";
    if (this.limits.textContent !== text) this.limits.textContent = text;
  }
}
