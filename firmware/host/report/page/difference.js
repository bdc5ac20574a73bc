// SPDX-License-Identifier: Apache-2.0
// Where the arm of a log moved otherwise than the simulated one, and what explains it.

(function () {
  const { el, plots, number } = Fovea;
  const body = (id) => document.querySelector(`#${id} .body`);

  // A line for each joint.
  function ofJoints(t, lists, more) {
    return lists.map((values, i) =>
      Object.assign(
        { name: `joint ${i + 1}`, tag: String(i + 1), run: 0, colour: `--joint-${i + 1}`, width: 1.5, t, v: values },
        more,
      ),
    );
  }

  function plot(host, label, series) {
    plots.create(host, { label, series, includeZero: true, height: 240, endLabels: true });
  }

  function table(heads, words, rows) {
    return Fovea.table(heads, rows, { number: (i) => !words.includes(i), named: false, scroll: true });
  }

  // The cells of a quantity: rms, worst, and when.
  const spread = (s, factor) => [number(factor * s.rms, 3), number(factor * s.worst, 3), s.worst_s.toFixed(3)];

  function draw() {
    const data = JSON.parse(document.querySelector("script.fovea-run").textContent);
    Fovea.runs = [Object.assign(data, { index: 0, letter: "A", modes: [] })];
    document.getElementById("title").textContent = data.log;
    document.getElementById("subtitle").textContent =
      `${data.ticks} ticks, windows of ${data.window_ms} ms` +
      (data.settings.length ? `; the simulated arm with ${data.settings.join(", ")}` : "");
    Fovea.clock.duration = Math.max(0.001, data.position_s[data.position_s.length - 1] || 0);
    Fovea.clock.span = [0, Fovea.clock.duration];
    body("causes").append(
      table(
        ["joint", "missing torque, rms [N m or N]", "likely cause: share explained (recorded arm less simulated)"],
        [0, 2],
        data.joints.map((joint) => [joint.name, number(joint.missing_torque.rms, 3), joint.likely_cause]),
      ),
    );
    body("torques").append(el("div", { class: "toolbar" }, Fovea.zoomBar()));
    plot(body("torques"), "missing torques [N m or N]", ofJoints(data.torque_s, data.torque));
    plot(body("torques"), "the part that the causes explain [N m or N]", ofJoints(data.torque_s, data.explained));
    plot(
      body("positions"),
      "simulated less recorded positions, since the begin of a window [rad or m]",
      ofJoints(data.position_s, data.position),
    );
    body("figures").append(
      table(
        ["joint", "quantity", "rms", "worst", "at [s]"],
        [0, 1],
        data.joints.flatMap((joint) => {
          const unit = joint.slides ? "mm" : "mrad";
          return [
            [joint.name, `position [${unit}]`, ...spread(joint.position, 1e3)],
            [joint.name, `velocity [${unit}/s]`, ...spread(joint.velocity, 1e3)],
            [joint.name, `acceleration [${joint.slides ? "m" : "rad"}/s²]`, ...spread(joint.acceleration, 1)],
            [joint.name, `missing torque [${joint.slides ? "N" : "N m"}]`, ...spread(joint.missing_torque, 1)],
          ];
        }),
      ),
    );
    ["causes", "torques", "positions", "figures"].forEach(Fovea.drawn);
  }

  draw();
})();
