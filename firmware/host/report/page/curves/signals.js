// SPDX-License-Identifier: Apache-2.0
// Every signal over time that the page has, for the free plot: {id, name, unit, run, t, v, dots}.

Fovea.signals = (function () {
  const { hasNumbers } = Fovea;
  const TWIST = ["vx", "vy", "vz", "ωx", "ωy", "ωz"];

  function of(run) {
    const list = [];
    const add = (id, name, unit, t, v, dots) => {
      if (t && hasNumbers(v)) list.push({ id, name, unit, run: run.index, t, v, dots });
    };
    const { ticks, measured, theory, feature_path: path } = run;
    const tick = (id, name, unit, v) => add(id, name, unit, ticks.t_s, v);
    tick("error_px", "image error, true", "px", ticks.error_px);
    tick("predicted_px", "image error, predicted by the servo", "px", ticks.predicted_px);
    add("measured_px", "image error, measured", "px", measured.t_s, measured.error_px, true);
    if (path)
      for (let k = 0; k < path.goal_px.length; k++)
        add(
          `feature.${k}`,
          `${k % 2 ? "v" : "u"} of ${path.goal_px.length > 2 ? `corner ${(k >> 1) + 1}` : "the target's centre"}, measured`,
          "px",
          path.t_s,
          Float32Array.from(path.t_s, (_, i) => path.px[i * path.goal_px.length + k]),
          true,
        );
    tick("error_mm", "position error, true", "mm", ticks.error_mm);
    tick("path_error_mm", "path error of the end effector", "mm", ticks.path_error_mm);
    run.error_components.forEach(({ name, unit }, i) => tick(`e.${i}`, `e: ${name}`, unit, ticks.e[i]));
    TWIST.forEach((axis, i) => {
      const unit = i < 3 ? "m/s" : "rad/s";
      tick(`twist_meas.${i}`, `camera ${axis}, measured`, unit, ticks.twist_meas[i]);
      tick(`twist_cmd.${i}`, `camera ${axis}, commanded`, unit, ticks.twist_cmd[i]);
    });
    run.joints.forEach((joint, i) => {
      const slides = joint.type === "prismatic";
      const which = `joint ${i + 1}`;
      tick(`q.${i}`, `${which} position`, slides ? "m" : "rad", ticks.q[i]);
      tick(`dq.${i}`, `${which} velocity`, slides ? "m/s" : "rad/s", ticks.dq[i]);
      tick(`tau.${i}`, `${which} torque, commanded without gravity`, slides ? "N" : "N m", ticks.tau[i]);
      tick(`tau_meas.${i}`, `${which} torque, measured`, slides ? "N" : "N m", ticks.tau_meas[i]);
      tick(`tau_ext.${i}`, `${which} torque, external`, slides ? "N" : "N m", ticks.tau_ext[i]);
    });
    add("age_ms", "age of the measurement when taken", "ms", measured.t_s, measured.age_ms, true);
    add("confidence", "confidence of the detection", "1", measured.t_s, measured.confidence, true);
    if (theory) {
      add("theory.x", "joint, simulated", "m", theory.t_s, theory.x);
      add("theory.goal", "joint, goal", "m", theory.t_s, theory.goal);
      add("theory.analytic", "joint, by theory", "m", theory.t_s, theory.analytic);
    }
    return list;
  }

  // One entry for each signal; it covers both runs.
  function all(runs) {
    const entries = new Map();
    for (const signal of runs.flatMap(of)) {
      const { id, name, unit } = signal;
      if (!entries.has(id)) entries.set(id, { id, name, unit, series: [] });
      entries.get(id).series.push(signal);
    }
    return Array.from(entries.values());
  }

  return { all };
})();
