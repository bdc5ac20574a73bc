// SPDX-License-Identifier: Apache-2.0
// Buttons: what the servo shall do, what to keep of the run, and who has control.

const { el } = Fovea;
const SURE_MS = 4000; // a button that asks again forgets the first press after this time

export class Commands {
  constructor(host, actions, model, token) {
    this.actions = actions;
    this.model = model;
    this.buttons = [
      this.#button("Hold", "/servo/hold", {
        title: "The arm stands still. Everybody may press this.",
        class: "strong",
      }),
      this.#button("Track", "/servo/track", { title: "The arm steers to the target." }),
      this.#button("Recover", "/servo/recover", { title: "Ends a fault." }),
      this.#button("Reset", "/run/reset", { title: "Back to the start of the scenario.", done: "Back at the start." }),
      this.#button("End", "/run/end", { title: "Ends the run.", sure: "End the run?" }),
    ];
    this.save = el("button", {
      type: "button",
      text: "Save",
      title: "Saves what you see as a scenario file.",
      onclick: () => this.#save(),
    });
    this.report = el("a", {
      class: "button",
      href: `report?token=${encodeURIComponent(token)}`,
      target: "_blank",
      rel: "noopener",
      text: "Report",
      title: "The report of the run so far, in a new tab.",
    });
    this.who = el("p", { class: "who" });
    this.control = el("button", { type: "button", onclick: () => this.#changeControl() });
    host.append(
      el(
        "div",
        { class: "buttons" },
        this.buttons.map((one) => one.node),
      ),
      el("div", { class: "buttons" }, this.save, this.report),
      el("div", { class: "control" }, this.who, this.control),
    );
    model.listen((what) => what === "state" && this.show());
    actions.connection.listen((what) => (what === "services" || what === "state") && this.show());
    this.show();
  }

  #button(text, service, { title, sure, done, ...more }) {
    const node = el("button", { type: "button", text, title, ...more });
    let asked = 0;
    const calm = () => {
      asked = 0;
      node.textContent = text;
      node.classList.remove("sure");
    };
    node.addEventListener("click", async () => {
      if (sure && !asked) {
        asked = setTimeout(calm, SURE_MS);
        node.textContent = sure;
        node.classList.add("sure");
        return;
      }
      clearTimeout(asked);
      calm();
      if ((await this.actions.call(service)) && done) this.actions.say(done, "done");
    });
    return { node, service };
  }

  show() {
    const { actions, model } = this;
    const { state } = model;
    for (const { node, service } of this.buttons) {
      const idle = service === "/servo/recover" && state?.mode !== "fault"; // nothing to recover from
      node.disabled = idle || !actions.may(service);
      node.hidden = actions.connection.state === "open" && !actions.connection.has(service);
    }
    this.report.hidden = !model.hasServo || actions.connection.state === "ended"; // a served robot has no log
    this.save.disabled = !actions.may("/run/save");
    this.save.hidden = actions.connection.state === "open" && !actions.connection.has("/run/save");
    const other = state?.controller && !actions.inControl;
    const watching = state && state.viewers > 1 ? ` ${state.viewers} people watch.` : "";
    const words = actions.inControl
      ? "You have control."
      : other
        ? `${state.controller} has control.`
        : "Nobody has control.";
    if (this.who.textContent !== words + watching) this.who.textContent = words + watching;
    this.control.textContent = actions.inControl ? "Give control" : "Take control";
    this.control.disabled = !actions.may("/control/take") || (other && actions.connection.state !== "open");
    this.control.hidden = !actions.connection.has("/control/take");
  }

  async #changeControl() {
    if (this.actions.inControl) await this.actions.call("/control/give");
    else
      try {
        await this.actions.takeControl();
      } catch (trouble) {
        this.actions.say(trouble.message);
      }
    this.show();
  }

  async #save() {
    const answer = await this.actions.call("/run/save");
    if (!answer) return;
    const url = URL.createObjectURL(new Blob([answer.toml], { type: "application/toml" }));
    el("a", { href: url, download: answer.name }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
    this.actions.say(`Saved as ${answer.name}. fovea-sim run FILE repeats it.`, "done");
  }
}
