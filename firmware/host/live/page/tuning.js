// SPDX-License-Identifier: Apache-2.0
// Numbers of the servo that may change in motion: servo.lambda, and those that were found by the search.
import { numberField } from "./number_field.js";

const { el, plain } = Fovea;
const FIRST = "servo.lambda";
const MOST_FOUND = 8;
const SEND_MS = 50; // between two settings of one slider

export class Tuning {
  #rows = new Map(); // name to {node, field, parameter}
  #waiting = new Map(); // name to the newest value of a moving slider

  constructor(host, actions, model) {
    this.actions = actions;
    this.model = model;
    this.list = el("div", { class: "tuned" });
    this.search = el("input", {
      type: "search",
      placeholder: "find a key, e.g. noise",
      "aria-label": "Find a key to change",
      autocomplete: "off",
      oninput: () => this.#find(),
      onkeydown: (event) => this.#searchKey(event),
    });
    this.found = el("ul", { class: "found" });
    this.absent = Fovea.absent("This run offers no numbers to change.");
    host.append(this.absent, this.list, this.search, this.found);
    model.listen((what) => {
      if (what === "parameters") this.#offer();
      if (what === "state") this.#allow();
    });
    actions.connection.listen((what, detail) => {
      if (what === "parameters") this.#told(detail);
      if (what === "state") this.#allow();
    });
    this.#offer();
  }

  #offer() {
    const known = this.model.parameters;
    this.absent.hidden = known.length > 0;
    this.search.hidden = known.length < 2;
    for (const [name, row] of this.#rows)
      if (!known.some((one) => one.name === name)) {
        row.node.remove();
        this.#rows.delete(name);
      }
    const first = known.find(({ name }) => name === FIRST) || known[0];
    if (first && !this.#rows.size) this.#add(first);
    this.#told(known);
    this.#find();
  }

  #add(parameter) {
    if (this.#rows.has(parameter.name)) return this.#rows.get(parameter.name);
    const { name, meaning, unit } = parameter;
    const field = numberField(parameter, name, (value) => this.#send(name, value));
    const words = `${meaning}${meaning && !meaning.endsWith(".") ? "." : ""} Default ${plain(parameter.default, 6)}${unit ? ` ${unit}` : ""}.`;
    const toDefault = el("button", {
      type: "button",
      class: "small",
      text: "Default",
      "aria-label": `${name} to its default`,
      onclick: () => this.#send(name, parameter.default),
    });
    const remove = el("button", {
      type: "button",
      class: "small",
      text: "×",
      "aria-label": `Hide ${name}`,
      hidden: name === FIRST,
      onclick: () => {
        node.remove();
        this.#rows.delete(name);
        this.#find();
      },
    });
    const node = el(
      "div",
      { class: "tuned-row", "data-name": name },
      el("div", { class: "tuned-head" }, el("code", { text: name }), toDefault, remove),
      field.row,
      field.refusal,
      el("p", { class: "note", text: words }),
    );
    this.list.append(node);
    const row = { node, field, parameter };
    this.#rows.set(name, row);
    this.#allow();
    return row;
  }

  // Not more often than the server takes them; the last one is always sent.
  #send(name, value) {
    const moving = this.#waiting.has(name);
    this.#waiting.set(name, value);
    if (moving) return;
    const send = async () => {
      const next = this.#waiting.get(name);
      if (next === null) return this.#waiting.delete(name);
      this.#waiting.set(name, null);
      setTimeout(send, SEND_MS);
      if (!(await this.actions.setParameter(name, next)))
        this.#told(this.model.parameters.filter((one) => one.name === name));
    };
    send();
  }

  // The values that hold now. A refused one goes back.
  #told(list) {
    for (const { name, value } of list || []) {
      if (name === FIRST && Number.isFinite(value)) this.model.lambda = value;
      const known = this.model.parameters.find((one) => one.name === name);
      if (known && Number.isFinite(value)) known.value = value;
      if (Number.isFinite(value) && !(this.#waiting.get(name) > -Infinity && this.#waiting.get(name) !== null))
        this.#rows.get(name)?.field.show(value);
    }
  }

  #allow() {
    const on = this.actions.may("tune");
    for (const { field, node } of this.#rows.values()) {
      field.enable(on);
      node.querySelector("button").disabled = !on;
    }
  }

  #find() {
    const words = this.search.value.trim().toLowerCase().split(/\s+/).filter(Boolean);
    const matches = words.length
      ? this.model.parameters.filter(
          ({ name, meaning }) =>
            !this.#rows.has(name) && words.every((word) => `${name} ${meaning}`.toLowerCase().includes(word)),
        )
      : [];
    const items = matches
      .slice(0, MOST_FOUND)
      .map((parameter) =>
        el(
          "li",
          {},
          el(
            "button",
            { type: "button", onclick: () => this.#choose(parameter) },
            el("code", { text: parameter.name }),
            el("span", { class: "note", text: parameter.meaning }),
          ),
        ),
      );
    const more = matches.length - items.length;
    if (more > 0) items.push(el("li", { class: "note", text: `and ${more} more: type another word` }));
    if (words.length && !matches.length)
      items.push(el("li", { class: "note", text: "No key that may change in motion has these words." }));
    this.found.replaceChildren(...items);
  }

  #searchKey(event) {
    const first = this.found.querySelector("button");
    if (event.key === "Enter" && first) first.click();
    else if (event.key === "ArrowDown" && first) first.focus();
    else if (event.key === "Escape") {
      this.search.value = "";
      this.#find();
    } else return;
    event.preventDefault();
  }

  #choose(parameter) {
    const { field } = this.#add(parameter);
    this.search.value = "";
    this.#find();
    field.slider.focus();
  }
}
