// SPDX-License-Identifier: Apache-2.0
// The head of the page: what the run does now, in words; and what went wrong, in one sentence.

const { el, fixed } = Fovea;
const NOTE_MS = 9000;
const LINK = { connecting: "connecting", open: "connected", lost: "connection lost", ended: "no connection" };
const RESTART_HINT_S = 15; // after this time a restarted program is likelier than a lost network

export class Status {
  constructor(head, banners, actions, model, moment) {
    Object.assign(this, { actions, model, moment });
    this.mode = el("span", { class: "chip mode" });
    this.reason = el("span", { class: "reason" });
    this.speed = el("span", { class: "chip quiet" });
    this.link = el("span", { class: "chip link" });
    head.append(this.mode, this.reason, this.speed, this.link);
    this.lost = el("div", { class: "note-bar bad", role: "alert", hidden: true });
    this.ended = el("div", {
      class: "note-bar warn",
      role: "status",
      hidden: true,
      text: "The run has ended. What was received stays here.",
    });
    this.notice = el("div", { class: "note-bar warn", role: "status", hidden: true });
    this.past = el(
      "div",
      { class: "note-bar past-bar", role: "status", hidden: true },
      el("span"),
      el("button", { type: "button", text: "Back to live", onclick: () => moment.goLive() }),
    );
    this.notes = el("div", { class: "notes", role: "status", "aria-live": "polite" });
    banners.append(this.lost, this.ended, this.notice, this.past, this.notes);
    actions.listen((words, kind) => this.#note(words, kind));
    model.listen((what) => what === "state" && this.show());
    moment.listen(() => this.show());
    actions.connection.listen((what) => what === "state" && this.#connection());
    setInterval(() => this.#connection(), 1000);
    this.#connection();
  }

  show() {
    const { state, setup } = this.model;
    if (!state) return;
    const mode = String(state.mode).toLowerCase();
    const fault = state.fault_words || Fovea.words(state.fault);
    this.mode.className = `chip mode ${mode}`;
    put(this.mode, mode);
    const why = fault ? `stopped by a fault: ${fault}` : state.hold_reason_words || Fovea.words(state.hold_reason);
    put(this.reason, why && mode !== "track" ? why : Fovea.modeWords(mode));
    this.reason.classList.toggle("bad", !!fault);
    const factor = `${fixed(state.real_time_factor, 1)} × real time`;
    put(this.speed, this.#hasEnded ? "ended" : state.paused ? "paused" : factor);
    this.ended.hidden = !this.#hasEnded;
    this.notice.hidden = !state.notice;
    put(this.notice, state.notice || "");
    this.past.hidden = this.moment.isLive;
    put(
      this.past.firstChild,
      `You look at the past: ${this.moment.t.toFixed(2)} s, ${(this.model.now - this.moment.t).toFixed(1)} s ago. The run goes on.`,
    );
    const name = setup?.name || state.name || "";
    if (name) document.title = `${mode ? `${mode}: ` : ""}${name} – Fovea`;
  }

  get #hasEnded() {
    return this.actions.connection.state === "ended" || !!this.model.state?.ends;
  }

  #connection() {
    const { connection } = this.actions;
    const lost = connection.state === "lost";
    put(this.link, LINK[connection.state]);
    this.link.className = `chip link ${connection.state}`;
    document.documentElement.classList.toggle("lost", lost);
    this.lost.hidden = !lost || this.#hasEnded;
    this.show();
    if (connection.state === "open" || connection.state === "connecting") {
      if (this.wasLost) this.#note("Connected again. What happened meanwhile is missing in the plots.", "done");
      this.wasLost = false;
      return;
    }
    this.wasLost = true;
    const since = Math.round((performance.now() - connection.lostAt) / 1000);
    const hint = since > RESTART_HINT_S ? " If the program was started again, open the address that it prints." : "";
    put(this.lost, `The connection is lost since ${since} s. The page connects again by itself.${hint}`);
  }

  #note(words, kind) {
    const same = [...this.notes.children].find((one) => one.firstChild.textContent === words);
    const note = same || this.#newNote(words, kind);
    clearTimeout(note.timer);
    note.timer = setTimeout(() => note.remove(), NOTE_MS);
  }

  #newNote(words, kind) {
    const note = el(
      "div",
      { class: `note-bar ${kind === "refused" ? "warn" : "good"}` },
      el("span", { text: words }),
      el("button", {
        type: "button",
        class: "small",
        text: "×",
        "aria-label": "Dismiss",
        onclick: () => note.remove(),
      }),
    );
    this.notes.prepend(note);
    while (this.notes.children.length > 3) this.notes.lastChild.remove();
    return note;
  }
}

const put = (node, words) => node.textContent !== words && (node.textContent = words);
