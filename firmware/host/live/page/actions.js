// SPDX-License-Identifier: Apache-2.0
// What a person may do, and what the page says when something is refused.

const IDLE_MS = 120_000; // a page that nobody touches for so long gives its control up
const ASK_AGAIN_MS = 1000; // a refusal of control holds so long
const FREE = new Set(["/servo/hold", "/control/take"]); // need no control
const MAY = { "/servo/hold": "hold", "/servo/track": "track", "/servo/recover": "recover", "/run/pause": "pause" };
Object.assign(MAY, { "/run/step": "step", "/run/speed": "speed", "/run/reset": "reset", "/run/save": "save" });
Object.assign(MAY, { "/run/end": "end", "/fault/start": "fault", "/fault/stop": "fault", "/arm/pull": "pull" });
Object.assign(MAY, { "/arm/release": "pull", "/target/throw": "throw" });

export class Actions {
  #listeners = Fovea.callbacks();

  constructor(connection, model) {
    this.connection = connection;
    this.model = model;
    this.name = `viewer ${Math.floor(1296 + Math.random() * 45360).toString(36)}`;
    this.touched = performance.now();
    for (const kind of ["pointerdown", "pointermove", "keydown", "wheel"])
      addEventListener(kind, () => (this.touched = performance.now()), { passive: true });
    model.listen((what) => {
      if (what === "state") connection.keepAlive = this.inControl && performance.now() - this.touched < IDLE_MS;
    });
    connection.listen((what, detail) => {
      if (what === "status" && detail.level > 0) this.say(detail.message, "refused");
      if (what === "state" && connection.state !== "open" && model.state) model.state.you = false;
    });
  }

  // Calls back with (words, kind): kind is refused or done.
  listen(callback) {
    return this.#listeners.listen(callback);
  }

  say(words, kind = "refused") {
    this.#listeners.tell(words, kind);
  }

  get inControl() {
    const { state } = this.model;
    return !!state && (state.you === undefined ? state.controller === this.name : state.you);
  }

  // Whether this run offers a service (or "tune", "target") at all.
  may(what) {
    const { state } = this.model;
    if (!state || state.ends || this.connection.state !== "open") return false;
    if (what.startsWith("/")) return this.connection.has(what) && state.may?.[MAY[what]] !== false;
    return state.may?.[what] !== false;
  }

  // Calls a service. Null when it was refused; the reason is shown.
  async call(service, request = {}) {
    try {
      await this.#needControl(service);
      return await this.connection.call(service, request);
    } catch (trouble) {
      this.say(trouble.message);
      return null;
    }
  }

  // False when the value may not be set; the reason is shown.
  setParameter(name, value) {
    return this.#change(() => this.connection.setParameter(name, value));
  }

  // Sends the pose of the held target. False when it may not be moved; the reason is shown.
  holdTarget(p_BO, q_BO) {
    return this.#change(() => this.connection.publish("/target/pose", { p_BO, q_BO }));
  }

  async #change(send) {
    try {
      await this.#needControl("");
      send();
      return true;
    } catch (trouble) {
      this.say(trouble.message);
      return false;
    }
  }

  async releaseTarget() {
    if (this.inControl) this.connection.publish("/target/release", {});
  }

  async takeControl() {
    const answer = await this.connection.call("/control/take", { name: this.name });
    if (!answer.granted && answer.controller === this.name)
      throw new Error("Your lost connection still has control for some seconds.");
    if (!answer.granted) throw new Error(`${answer.controller} has control. Ask them to give it up.`);
    this.model.state.you = true; // the next state says so too
  }

  // Takes control when nobody has it; the answer to that comes before the change is sent.
  #needControl(service) {
    const free = FREE.has(service) || (service === "/run/end" && this.model.state?.may?.end_at_once);
    if (free || this.inControl || !this.connection.has("/control/take")) return Promise.resolve();
    if (!this.taking) {
      const end = () => (this.taking = null);
      this.taking = this.takeControl();
      this.taking.then(end, () => setTimeout(end, ASK_AGAIN_MS));
    }
    return this.taking;
  }
}
