// SPDX-License-Identifier: Apache-2.0
// A one-joint arm and its analytic solution: their positions, the difference, and the figures of both.

Fovea.theory = (function () {
  const { el, plots, number } = Fovea;

  function poles(list) {
    if (!list || !list.length) return "–";
    return list
      .map(([re, im]) => number(re, 4) + (im ? (im > 0 ? " + " : " − ") + number(Math.abs(im), 4) + " i" : ""))
      .join(", ");
  }

  function figures(run) {
    const figures = run.summary && run.summary.theory;
    if (!figures) return null;
    const rows = [
      ["damping ratio ζ", "zeta", ""],
      ["natural frequency ωₙ", "omega_n", "rad/s"],
      ["settled after", "settle_time_s", "s"],
      ["steady-state error", "e_ss", "m"],
    ].map(([name, key, unit]) => [name, figures[key], figures.analytic[key], unit]);
    const cell = (value, unit) => (Number.isFinite(value) ? `${number(value, 4)} ${unit}`.trim() : "–");
    const table = Fovea.table(
      ["", "simulated", "theory"],
      [
        ...rows.map(([name, run_value, analytic, unit]) => [name, cell(run_value, unit), cell(analytic, unit)]),
        ["poles [1/s]", poles(figures.poles), poles(figures.analytic.poles)],
      ],
      { class: "figures" },
    );
    const words = `The two positions are at most ${number(1000 * figures.residual_max)} mm apart, ${number(
      1000 * figures.residual_rms,
    )} mm rms; after the first second the error is at most ${number(1000 * figures.error_max)} mm.`;
    return el("div", {}, table, el("p", { class: "note", text: words }));
  }

  function draw(runs) {
    const shown = runs.filter((run) => run.theory);
    const body = document.querySelector("#theory .body");
    const series = [];
    const errors = [];
    const apart = [];
    for (const run of shown) {
      const { t_s: t, x, goal, analytic } = run.theory;
      series.push({ name: "goal", run: run.index, t, v: goal, colour: "--quiet", width: 1.4, dash: [2, 3] });
      series.push({ name: "theory", run: run.index, t, v: analytic, colour: "--orange", width: 4 });
      series.push({ name: "simulated", run: run.index, t, v: x, colour: "--blue", width: 1.6 });
      const less = (values) => goal.map((value, i) => value - values[i]);
      errors.push({ name: "theory", run: run.index, t, v: less(analytic), colour: "--orange", width: 4 });
      errors.push({ name: "simulated", run: run.index, t, v: less(x), colour: "--blue", width: 1.6 });
      apart.push({
        name: "simulated minus theory",
        run: run.index,
        t,
        v: x.map((value, i) => 1000 * (value - analytic[i])),
        colour: "--purple",
        width: 1.6,
      });
    }
    body.append(el("div", { class: "toolbar" }, Fovea.zoomBar()));
    const key = Fovea.bands.legend(runs);
    if (key) body.append(key);
    plots.create(body, { label: "position of the joint [m]", series, height: 260 });
    plots.create(body, { label: "error: goal minus actual [m]", series: errors, height: 260, includeZero: true });
    plots.create(body, { label: "simulated minus theory [mm]", series: apart, height: 170, includeZero: true });
    for (const run of shown) {
      const table = figures(run);
      if (table) body.append(table);
    }
    Fovea.drawn("theory");
  }

  return { draw };
})();
