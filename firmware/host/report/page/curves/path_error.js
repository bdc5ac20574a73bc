// SPDX-License-Identifier: Apache-2.0
// Distance of the end effector from its commanded position, for runs that command poses.

Fovea.pathError = (function () {
  const { el, plots, hasNumbers, number, suffix } = Fovea;

  const isShown = (run) => !!run.ticks.t_s && hasNumbers(run.ticks.path_error_mm);

  function words(run) {
    const s = run.summary || {};
    const parts = [];
    if (Number.isFinite(s.path_error_mm_max))
      parts.push(
        `Distance from the path: at most ${number(s.path_error_mm_max)} mm, ${number(s.path_error_mm_rms)} mm rms, by the simulator's truth`,
      );
    const bound = Fovea.setting(run, "motion.bound_mm");
    if (bound !== null) parts.push(`motion.bound_mm allows ${bound} mm`);
    return parts.length ? `${suffix(run) ? `Run${suffix(run)}: ` : ""}${parts.join("; ")}.` : null;
  }

  function draw(runs) {
    const body = document.querySelector("#way .body");
    const shown = runs.filter(isShown);
    body.append(el("div", { class: "toolbar" }, Fovea.zoomBar()));
    const key = Fovea.bands.legend(runs);
    if (key) body.append(key);
    const bounds = new Set(shown.map((run) => Number(Fovea.setting(run, "motion.bound_mm") || NaN)));
    plots.create(body, {
      label: "path error [mm]",
      summary: "path error: from the end effector to its commanded position [mm]",
      series: shown.map((run) => ({
        name: "end effector to commanded position",
        run: run.index,
        colour: "--blue",
        width: 1.8,
        t: run.ticks.t_s,
        v: run.ticks.path_error_mm,
      })),
      lines: Array.from(bounds)
        .filter(Number.isFinite)
        .map((value) => ({ value, text: `motion.bound_mm ${value}` })),
      includeZero: true,
      height: 260,
    });
    const notes = shown.map(words).filter(Boolean);
    body.append(
      el("p", {
        class: "hint",
        text: "Computed from the measured joints and the arm's model, in each tick that commands a pose.",
      }),
      ...notes.map((text) => el("p", { class: "hint", text })),
    );
    Fovea.drawn("way");
  }

  return { draw, isShown };
})();
