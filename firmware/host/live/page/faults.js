// SPDX-License-Identifier: Apache-2.0
// Faults that a person puts into the run: start, stop, and the numbers that size each.
import { numberField } from "./number_field.js";

const { el } = Fovea;
const RESEND_MS = 120; // between two changes of an active fault

export class Faults {
  #rows = new Map(); // name to {node, button, fields: [{name, field, value}]}

  constructor(host, actions, model) {
    this.actions = actions;
    this.model = model;
    this.list = el("ul", { class: "faults" });
    this.absent = Fovea.absent("This run offers no faults to inject.");
    host.append(this.absent, this.list);
    model.listen((what) => what === "state" && this.show());
    actions.connection.listen(() => this.show());
  }

  show() {
    const faults = this.model.state?.faults || [];
    this.absent.hidden = faults.length > 0;
    for (const fault of faults) {
      if (!this.#rows.has(fault.name)) this.#add(fault);
      this.#update(fault, this.#rows.get(fault.name));
    }
  }

  #add({ name, words, settings }) {
    const row = { active: false, timer: 0 };
    row.button = el("button", { type: "button", onclick: () => this.#toggle(name, row) });
    row.fields = settings.map((setting) => {
      const one = { name: setting.name, value: setting.value };
      one.field = numberField(setting, `${words || name}: ${setting.words || setting.name}`, (value) => {
        one.value = value;
        one.own = true;
        if (row.active) this.#resend(name, row);
      });
      one.node = el(
        "div",
        { class: "fault-setting" },
        el("span", { class: "note", text: setting.words || Fovea.words(setting.name) }),
        one.field.row,
        one.field.refusal,
      );
      return one;
    });
    const sizes = row.fields.length
      ? el(
          "details",
          {},
          el("summary", { text: "How strong" }),
          row.fields.map((one) => one.node),
        )
      : null;
    const label = el("span", { class: "fault-name", text: words || Fovea.words(name) });
    row.node = el("li", { "data-fault": name }, el("div", { class: "fault-head" }, label, row.button), sizes);
    row.label = label.textContent;
    this.#rows.set(name, row);
    this.list.append(row.node);
  }

  #update({ active, settings }, row) {
    row.active = active;
    row.node.classList.toggle("active", active);
    const words = active ? "Stop" : "Start";
    if (row.button.textContent !== words) {
      row.button.textContent = words;
      row.button.setAttribute("aria-label", `${words}: ${row.label}`);
    }
    const on = this.actions.may("/fault/start");
    row.button.disabled = !on;
    settings.forEach(({ value }, i) => {
      const one = row.fields[i];
      one.field.enable(on);
      if (one.own && !active) return; // what was chosen for the next start stays
      if (row.timer) return;
      one.value = value;
      one.field.show(value);
    });
  }

  #sizes(row) {
    const settings = Object.fromEntries(row.fields.map(({ name, value }) => [name, value]));
    return row.fields.length ? { settings } : {};
  }

  #toggle(name, row) {
    if (row.active) this.actions.call("/fault/stop", { name });
    else this.actions.call("/fault/start", { name, ...this.#sizes(row) });
  }

  #resend(name, row) {
    if (row.timer) return;
    row.timer = setTimeout(async () => {
      row.timer = 0;
      if (row.active) await this.actions.call("/fault/start", { name, ...this.#sizes(row) });
    }, RESEND_MS);
  }
}
