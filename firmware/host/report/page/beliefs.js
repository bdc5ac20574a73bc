// SPDX-License-Identifier: Apache-2.0
// What a run tells of the values that its servo believes.

Fovea.beliefs = (function () {
  const { el, number } = Fovea;

  const isShown = (run) => !!(run.summary && run.summary.beliefs && run.summary.beliefs.values);

  // With the digits that the standard deviation needs. Without a configured number: the difference, signed.
  function found({ known, configured, difference, sigma, unit }) {
    if (!known) return "unknown";
    const digits = Math.min(6, Math.max(0, -Math.floor(Math.log10(Math.max(sigma, 1e-6)))));
    const isWhole = Number.isFinite(configured);
    const value = isWhole ? configured + difference : difference;
    const sign = value < 0 ? "−" : isWhole ? "" : "+";
    return `${sign}${Math.abs(value).toFixed(digits)} ± ${sigma.toFixed(digits)} ${unit}${isWhole ? "" : " off"}`;
  }

  function tableOf(beliefs) {
    const rows = beliefs.map(([name, belief]) => ({
      class: belief.known ? null : "unknown",
      cells: [
        [name, el("span", { class: "note", text: belief.key })],
        Number.isFinite(belief.configured) ? `${number(belief.configured)} ${belief.unit}` : "",
        found(belief),
      ],
    }));
    return Fovea.table(["Belief, and the key to set", "Configured", "Found"], rows, { scroll: true });
  }

  const list = (sentences) => (sentences.length ? el("ul", {}, ...sentences.map((text) => el("li", { text }))) : null);

  function ofRun(run, several) {
    const { verdict = [], learnt = [], values } = run.summary.beliefs;
    const beliefs = Object.entries(values);
    const isOfJoint = ([name]) => /joint/.test(name);
    const ofJoints = beliefs.filter(isOfJoint);
    return [
      several ? el("h3", { text: `Run ${run.letter}: ${run.name}` }) : null,
      verdict.length
        ? list(verdict)
        : el("p", { text: "Nothing is wrong for certain. What is unknown, this motion does not tell." }),
      list(learnt.map(({ text }) => `Learnt while running: ${text}`)),
      tableOf(beliefs.filter((belief) => !isOfJoint(belief))),
      ofJoints.length
        ? el("details", {}, el("summary", { text: "What is told of each joint" }), tableOf(ofJoints))
        : null,
    ].filter(Boolean);
  }

  function draw(runs) {
    const body = document.querySelector("#beliefs .body");
    runs.filter(isShown).forEach((run) => body.append(...ofRun(run, runs.length > 1)));
    Fovea.drawn("beliefs");
  }

  return { draw, isShown };
})();
