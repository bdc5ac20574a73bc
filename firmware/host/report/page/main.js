// SPDX-License-Identifier: Apache-2.0
// Draws the sections one after the other, so that the verdict is readable at once.

(function () {
  const sections = [
    ["verdict", "verdict"],
    ["eye", "eye"],
    ["theory", "theory"],
    ["error", "error"],
    ["components", "components"],
    ["features", "featurePath"],
    ["way", "pathError"],
    ["velocity", "velocity"],
    ["joints", "joints"],
    ["timeline", "timeline"],
    ["free", "freePlot"],
    ["beliefs", "beliefs"],
    ["ticks", "ticks"],
    ["config", "config"],
    ["about", "footer"],
    ["path", "armView"],
  ];

  // Removes a section that no run of this page needs, and the link to it.
  function dropSection(id) {
    document.getElementById(id).remove();
    document.querySelector(`a[href="#${id}"]`).remove();
    sections.splice(
      sections.findIndex(([name]) => name === id),
      1,
    );
  }

  // A section that cannot be drawn shows its error; the others are still drawn.
  function draw([id, name]) {
    try {
      Fovea[name].draw(Fovea.runs);
    } catch (trouble) {
      const section = document.getElementById(id);
      (section.querySelector(".body") || section).append(
        Fovea.absent(`This part could not be drawn: ${trouble.message}.`),
      );
      section.dataset.drawn = "true";
      section.dataset.trouble = String(trouble.stack || trouble);
    }
  }

  function start() {
    Fovea.runs = Fovea.readRuns().slice(0, 2);
    if (!Fovea.runs.length) {
      document.querySelector("main").prepend(Fovea.absent("This page holds no run."));
      return;
    }
    if (!Fovea.runs.some((run) => run.theory)) dropSection("theory");
    if (!Fovea.runs.some((run) => run.has_eye)) ["eye", "error", "components", "features"].forEach(dropSection);
    if (!Fovea.runs.some(Fovea.beliefs.isShown)) dropSection("beliefs");
    if (!Fovea.runs.some(Fovea.pathError.isShown)) dropSection("way");
    Fovea.clock.duration = Math.max(0.001, ...Fovea.runs.map((run) => run.duration_s));
    Fovea.clock.span = [0, Fovea.clock.duration];
    const waiting = sections.slice();
    draw(waiting.shift());
    const next = () => {
      if (waiting.length) {
        draw(waiting.shift());
        setTimeout(next, 0);
      }
    };
    requestAnimationFrame(() => setTimeout(next, 0));
    // A print must show everything, also before all sections are drawn.
    addEventListener(
      "beforeprint",
      () => {
        while (waiting.length) draw(waiting.shift());
      },
      true,
    );
  }

  start();
})();
