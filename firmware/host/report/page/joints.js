// SPDX-License-Identifier: Apache-2.0
// Positions, velocities and torques of all joints, as shares of their limits or in physical units.

Fovea.joints = (function () {
  const { el, plots, hasNumbers, number, plain, fixed, suffix } = Fovea;

  // The quantities of the plots: title, limits, and units.
  const QUANTITIES = {
    q: { title: "position", low: (j) => j.q_min, high: (j) => j.q_max, unit: ["rad", "m"], range: true },
    dq: { title: "velocity", low: (j) => -j.dq_max, high: (j) => j.dq_max, unit: ["rad/s", "m/s"] },
    tau: {
      title: "commanded torque without gravity",
      low: (j) => -j.tau_max,
      high: (j) => j.tau_max,
      unit: ["N m", "N"],
    },
    tau_meas: { title: "measured torque", low: (j) => -j.tau_max, high: (j) => j.tau_max, unit: ["N m", "N"] },
    tau_ext: {
      title: "external torque, as the servo observes it",
      low: (j) => -j.tau_max,
      high: (j) => j.tau_max,
      unit: ["N m", "N"],
    },
  };

  const limited = (kind, joint) =>
    Number.isFinite(kind.low(joint)) && Number.isFinite(kind.high(joint)) && kind.high(joint) > kind.low(joint);

  // A value as percent of the way from the middle of its range to its limit: ±100 is at the limit.
  function share(kind, joint, values) {
    const middle = (kind.high(joint) + kind.low(joint)) / 2;
    const half = (kind.high(joint) - kind.low(joint)) / 2;
    return values.map((v) => (100 * (v - middle)) / half);
  }

  function seriesOf(runs, key, physical, only) {
    const kind = QUANTITIES[key];
    const series = [];
    for (const run of runs) {
      run.joints.forEach((joint, i) => {
        const values = run.ticks[key][i];
        if (!values || !run.ticks.t_s || (only !== null && only !== i) || (only === null && !hasNumbers(values)))
          return;
        if (!physical && !limited(kind, joint)) return;
        series.push({
          name: `joint ${i + 1}`,
          tag: run.index ? null : String(i + 1),
          run: run.index,
          colour: `--joint-${i + 1}`,
          width: 1.5,
          t: run.ticks.t_s,
          v: physical ? values : share(kind, joint, values),
        });
      });
    }
    return series;
  }

  function settings(runs, key, physical, only, fit) {
    const kind = QUANTITIES[key];
    const joints = runs[0].joints;
    // Without limits there is no share: physical units are shown.
    if (!(only === null ? joints : [joints[only]]).some((joint) => limited(kind, joint))) physical = true;
    const series = seriesOf(runs, key, physical, only);
    const sliding = (only === null ? joints : [joints[only]]).map((j) => (j.type === "prismatic" ? 1 : 0));
    const unit = Array.from(new Set(sliding))
      .sort()
      .map((k) => kind.unit[k])
      .join(" or ");
    if (!physical) {
      let top = 0;
      for (const s of series) for (const v of s.v) if (Math.abs(v) > top) top = Math.abs(v);
      const edge = Math.max(112, Math.min(top * 1.08, 400));
      return {
        series,
        label: `${kind.title} [% of the limit]`,
        range: fit ? null : [-edge, edge],
        format: (v) => (Number.isFinite(v) ? fixed(v, 0) + " %" : "–"),

        lines: [
          { value: 100, text: kind.range ? "upper limit" : "limit" },
          { value: -100, above: true, text: kind.range ? "lower limit" : "limit" },
          { value: 0, colour: "--axis", alpha: 0.6, dash: [] },
        ],
      };
    }
    const lines = [];
    joints.forEach((joint, i) => {
      if ((only !== null && only !== i) || !limited(kind, joint)) return;
      for (const value of [kind.low(joint), kind.high(joint)]) {
        if (only !== null)
          lines.push({ value, above: value === kind.low(joint), text: `limit ${plain(value)} ${unit}` });
        else lines.push({ value, colour: `--joint-${i + 1}`, alpha: 0.7 });
      }
    });
    let range = null;
    if (lines.length) {
      const all = lines.map((l) => l.value);
      const low = Math.min(...all);
      const high = Math.max(...all);
      range = [low - 0.08 * (high - low), high + 0.08 * (high - low)];
    }
    return { series, label: `${kind.title} [${unit}]`, range: fit ? null : range, lines, format: (v) => number(v, 3) };
  }

  function extremes(values) {
    let low = Infinity;
    let high = -Infinity;
    for (const v of values || []) {
      if (v < low) low = v;
      if (v > high) high = v;
    }
    return low <= high ? { low, high, size: Math.max(-low, high) } : null;
  }

  // The peaks of every joint beside its limits.
  function table(run) {
    const cell = (size, limit) => {
      const text =
        size === null
          ? "–"
          : Number.isFinite(limit) && limit > 0
            ? `${number(size, 3)} of ${plain(limit)} (${fixed((100 * size) / limit, 0)} %)`
            : number(size, 3);
      return { class: size !== null && size > limit ? "over" : null, of: text };
    };
    const rows = run.joints.map((joint, i) => {
      const q = extremes(run.ticks.q[i]);
      const dq = extremes(run.ticks.dq[i]);
      const tau = extremes(run.ticks.tau[i]);
      const margin = q && Number.isFinite(joint.q_min) ? Math.min(q.low - joint.q_min, joint.q_max - q.high) : null;
      return [
        [
          el("span", { class: "joint-dot", style: `background:var(--joint-${i + 1})`, "aria-hidden": "true" }),
          `${i + 1} `,
          el("span", { class: "quiet", text: joint.name }),
        ],
        {
          class: margin !== null && margin < 0 ? "over" : null,
          of: q ? `${number(q.low, 3)} … ${number(q.high, 3)}` : "–",
        },
        number(margin, 3),
        cell(dq && dq.size, joint.dq_max),
        cell(tau && tau.size, joint.tau_max),
      ];
    });
    const slides = run.joints.some((j) => j.type === "prismatic");
    const turn = slides ? "rad or m" : "rad";
    const heads = [
      "Joint",
      `Positions [${turn}]`,
      `Margin to the nearer limit [${turn}]`,
      `Peak velocity [${slides ? "rad/s or m/s" : "rad/s"}]`,
      `Peak torque [${slides ? "N m or N" : "N m"}]`,
    ];
    return el(
      "details",
      { class: "peaks" },
      el("summary", { text: `Peaks and limits of every joint in numbers${suffix(run) && ", run" + suffix(run)}` }),
      Fovea.table(heads, rows, { number: (i) => i > 0, scroll: true }),
    );
  }

  function draw(runs) {
    const body = document.querySelector("#joints .body");
    const bars = Fovea.limits.bars(runs);
    if (bars) body.append(bars);
    if (!runs[0].joints.length) {
      body.append(Fovea.absent("The log does not describe the joints."));
      return Fovea.drawn("joints");
    }
    let physical = false;
    let only = null;
    let fit = false;
    let torque = "tau";
    const shown = [];
    const redraw = () =>
      shown.forEach((plot) =>
        plot.plot.change(settings(runs, plot.key === "tau" ? torque : plot.key, physical, only, fit)),
      );
    const bar = el(
      "div",
      { class: "toolbar" },
      Fovea.choice(
        "Units of the joint plots",
        [
          ["share", "Share of the limit"],
          ["units", "Physical units"],
        ],
        "share",
        (key) => {
          physical = key === "units";
          redraw();
        },
      ),
    );
    const pick = el(
      "select",
      {
        "aria-label": "Joints to show",
        onchange: () => {
          only = pick.value === "all" ? null : Number(pick.value);
          redraw();
        },
      },
      el("option", { value: "all", text: "all joints" }),
      runs[0].joints.map((joint, i) => el("option", { value: i, text: `joint ${i + 1}: ${joint.name}` })),
    );
    bar.append(pick);
    const torques = [
      ["tau", "Commanded torque"],
      ["tau_meas", "Measured"],
      ["tau_ext", "External"],
    ].filter(([key]) => runs.some((run) => run.ticks[key].some(hasNumbers)));
    if (torques.length) torque = torques[0][0];
    if (torques.length > 1)
      bar.append(
        Fovea.choice("Which torque", torques, torque, (key) => {
          torque = key;
          redraw();
        }),
      );
    const box = el("input", {
      type: "checkbox",
      onchange: () => {
        fit = box.checked;
        redraw();
      },
    });
    bar.append(el("label", {}, box, " fit to the data"), Fovea.zoomBar());
    body.append(bar);
    const key = Fovea.bands.legend(runs);
    if (key) body.append(key);
    const missing = [];
    for (const key of ["q", "dq", "tau"]) {
      const first = settings(runs, key === "tau" ? torque : key, physical, only, fit);
      if (first.series.length)
        shown.push({ key, plot: plots.create(body, Object.assign({ height: 230, endLabels: true }, first)) });
      else missing.push(key === "tau" ? "torques" : key === "q" ? "positions" : "velocities");
    }
    if (missing.length)
      body.append(Fovea.absent(`The log holds no ${missing.join(", no ")} of the joints, or no limits for them.`));
    body.append(
      el("p", {
        class: "hint",
        text: "Share of the limit: 0 % is the middle of a joint’s range (or standing still, or no torque), ±100 % is the limit of that joint. The number at the right end of a line is its joint.",
      }),
    );
    runs.forEach((run) => body.append(table(run)));
    Fovea.drawn("joints");
  }

  return { draw };
})();
