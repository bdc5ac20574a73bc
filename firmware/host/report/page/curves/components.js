// SPDX-License-Identifier: Apache-2.0
// The components of the servo's error e = s* − s over time, in the units of s: one plot for each unit.

Fovea.components = (function () {
  const { el, plots, hasNumbers } = Fovea;

  function seriesOf(runs) {
    return runs.flatMap((run) =>
      run.error_components
        .map((component, i) => ({
          name: component.name,
          unit: component.unit,
          run: run.index,
          colour: `--joint-${(i % 8) + 1}`,
          width: 1.6,
          t: run.ticks.t_s,
          v: run.ticks.e[i],
        }))
        .filter((s) => s.t && hasNumbers(s.v)),
    );
  }

  function draw(runs) {
    const body = document.querySelector("#components .body");
    const series = seriesOf(runs);
    if (!series.length) {
      body.append(Fovea.absent("The log holds no error of the servo: it never knew the target."));
      return Fovea.drawn("components");
    }
    body.append(el("div", { class: "toolbar" }, Fovea.zoomBar()));
    const key = Fovea.bands.legend(runs);
    if (key) body.append(key);
    for (const unit of Array.from(new Set(series.map((s) => s.unit))))
      plots.create(body, {
        label: unit === "1" ? "components of e = s* − s [no unit]" : `components of e = s* − s [${unit}]`,
        series: series.filter((s) => s.unit === unit),
        includeZero: true,
        height: 240,
      });
    body.append(
      el("p", {
        class: "hint",
        text: "s is the feature that the servo controls, predicted for each tick; s* is its goal. At the goal all components are 0.",
      }),
    );
    Fovea.drawn("components");
  }

  return { draw };
})();
