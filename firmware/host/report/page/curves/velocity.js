// SPDX-License-Identifier: Apache-2.0
// The camera's velocity in its own axes: measured (from the joints) and commanded by the servo.

Fovea.velocity = (function () {
  const { el, plots, hasNumbers } = Fovea;
  const AXES = ["x", "y", "z"];

  // With two runs, dashes mark run B, and the width tells commanded from measured.
  function seriesOf(runs, letter, first) {
    const single = runs.length === 1;
    return runs
      .flatMap((run) =>
        AXES.flatMap((axis, i) => {
          const base = { run: run.index, colour: `--joint-${i + 1}`, t: run.ticks.t_s };
          return [
            { name: `${letter}${axis} measured`, width: 1.3, v: run.ticks.twist_meas[first + i], ...base },
            {
              name: `${letter}${axis} commanded`,
              width: single ? 2 : 3,
              dash: single ? [6, 4] : null,
              v: run.ticks.twist_cmd[first + i],
              ...base,
            },
          ];
        }),
      )
      .filter((s) => s.t && hasNumbers(s.v));
  }

  function draw(runs) {
    const body = document.querySelector("#velocity .body");
    const parts = [
      { label: "velocity v of the camera, in axes of C [m/s]", series: seriesOf(runs, "v", 0) },
      { label: "angular velocity ω of the camera, in axes of C [rad/s]", series: seriesOf(runs, "ω", 3) },
    ].filter((part) => part.series.length);
    if (!parts.length) {
      body.append(Fovea.absent("The log holds no velocity of the camera."));
      return Fovea.drawn("velocity");
    }
    body.append(el("div", { class: "toolbar" }, Fovea.zoomBar()));
    const key = Fovea.bands.legend(runs);
    if (key) body.append(key);
    parts.forEach((part) => plots.create(body, { includeZero: true, height: 240, ...part }));
    body.append(
      el("p", {
        class: "hint",
        text: "Axes of C: x to the right in the picture, y down, z along the line of sight. Measured: from the measured positions and velocities of the joints and the arm's model. Commanded: the servo's reference, after its limits.",
      }),
    );
    if (!parts.some((part) => part.series.some((s) => s.name.endsWith("measured"))))
      body.append(Fovea.absent("The log does not hold the arm's model, so there is no measured velocity."));
    Fovea.drawn("velocity");
  }

  return { draw };
})();
