// SPDX-License-Identifier: Apache-2.0
// The moment that is looked at: now, or a time in the last minute.

export class Moment {
  #listeners = Fovea.callbacks();

  constructor(model) {
    this.model = model;
    this.past = null; // [s]; null: now
    model.listen((what) => {
      if (what === "reset") this.goLive();
    });
  }

  listen(callback) {
    return this.#listeners.listen(callback);
  }

  // The shown time [s].
  get t() {
    if (this.past === null) return this.model.now;
    return Math.max(this.past, this.model.oldest);
  }

  get isLive() {
    return this.past === null;
  }

  lookAt(t) {
    this.past = Math.min(this.model.now, Math.max(this.model.oldest, t));
    this.#listeners.tell();
  }

  goLive() {
    if (this.past === null) return;
    this.past = null;
    this.#listeners.tell();
  }
}
