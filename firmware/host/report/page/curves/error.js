// SPDX-License-Identifier: Apache-2.0
// Image error over time: true, measured, predicted, and the ideal exponential; position error and age beneath.

Fovea.error = (function () {
  const { el, hasNumbers, plots } = Fovea;

  // e0 * exp(-lambda (t - t0)) from the moment the servo first tracks, on 300 points; null for a moving target,
  // and for an arm that follows a plan.
  function ideal(run) {
    const start = run.modes.find((m) => m.mode === "track");
    if (!start || !run.lambda || run.target.moves || run.ways.some((w) => w.way === "plan")) return null;
    const reach = run.duration_s / 20;
    const first = (times, values) => {
      if (!times || !values) return NaN;
      const exact = Fovea.valueAt(times, values, start.t_s, reach);
      if (Number.isFinite(exact)) return exact;
      for (let i = 0; i < times.length; i++) if (times[i] >= start.t_s && Number.isFinite(values[i])) return values[i];
      return NaN;
    };
    let e0 = first(run.ticks.t_s, run.ticks.error_px);
    if (!Number.isFinite(e0)) e0 = first(run.measured.t_s, run.measured.error_px);
    if (!Number.isFinite(e0) || e0 <= 0) return null;
    const t = new Float32Array(300).map((_, i) => start.t_s + ((run.duration_s - start.t_s) * i) / 299);
    return { t, v: t.map((time) => e0 * Math.exp(-run.lambda * (time - start.t_s))) };
  }

  function imageSeries(runs) {
    const series = [];
    const add = (run, name, t, v, more) => {
      if (t && hasNumbers(v)) series.push(Object.assign({ name, run: run.index, t, v }, more));
    };
    const single = runs.length === 1;
    for (const run of runs)
      add(run, "measured", run.measured.t_s, run.measured.error_px, { colour: "--orange", dots: true, size: 2.8 });
    for (const run of runs) {
      const line = ideal(run);
      if (line)
        add(run, "ideal", line.t, line.v, { colour: "--quiet", width: 1.4, dash: single ? [10, 4, 2, 4] : null });
      add(run, "true", run.ticks.t_s, run.ticks.error_px, { colour: "--blue", width: 2.4 });
      add(run, "predicted by the servo", run.ticks.t_s, run.ticks.predicted_px, {
        colour: "--green",
        width: 1.4,
        dash: single ? [6, 4] : null,
      });
    }
    return series;
  }

  function oneQuantity(runs, name, colour, pick) {
    return runs
      .map((run) => Object.assign({ name, run: run.index, colour, width: 1.8 }, pick(run)))
      .filter((s) => s.t && hasNumbers(s.v));
  }

  // The range of the log scale: whole decades around the values, without the ideal's endless tail.
  function decades(series) {
    const values = [];
    for (const s of series) if (s.name !== "ideal") for (const v of s.v) if (v > 0) values.push(v);
    values.sort((a, b) => a - b);
    if (!values.length) return null;
    const low = Math.pow(10, Math.floor(Math.log10(values[Math.floor(values.length * 0.01)])));
    return [low, Math.max(values[values.length - 1] * 1.4, low * 10)];
  }

  function draw(runs) {
    const body = document.querySelector("#error .body");
    const series = imageSeries(runs);
    const scale = (list, log) => ({ log, range: log ? decades(list) : null, includeZero: !log });
    const scaled = [];
    if (!series.length)
      body.append(Fovea.absent("The log holds no image error: neither the truth nor a measurement nor a prediction."));
    else {
      const choose = (key) => scaled.forEach(({ plot, list }) => plot.change(scale(list, key === "log")));
      body.append(
        el(
          "div",
          { class: "toolbar" },
          Fovea.choice(
            "Scale of the errors",
            [
              ["linear", "Linear"],
              ["log", "Logarithmic"],
            ],
            "linear",
            choose,
          ),
          Fovea.zoomBar(),
        ),
      );
      const key = Fovea.bands.legend(runs);
      if (key) body.append(key);
      scaled.push({
        list: series,
        plot: plots.create(
          body,
          Object.assign({ label: "image error [px]", series, height: 300 }, scale(series, false)),
        ),
      });
    }
    const pair = el("div", { class: "columns" });
    body.append(pair);
    const truth = oneQuantity(runs, "true", "--blue", (run) => ({ t: run.ticks.t_s, v: run.ticks.error_mm }));
    const age = oneQuantity(runs, "age", "--purple", (run) => ({
      t: run.measured.t_s,
      v: run.measured.age_ms,
      dots: true,
    }));
    const confidence = oneQuantity(runs, "confidence", "--orange", (run) => ({
      t: run.measured.t_s,
      v: run.measured.confidence,
      dots: true,
    }));
    const small = (label, list, more) => {
      if (!list.length) return null;
      const cell = el("div");
      pair.append(cell);
      return plots.create(cell, Object.assign({ label, series: list, includeZero: true, height: 190 }, more));
    };
    const position = small("position error [mm]", truth);
    if (position) scaled.push({ list: truth, plot: position });
    small("age of the measurement when taken [ms]", age);
    if (!truth.length) small("confidence of the detection [0 to 1]", confidence, { range: [0, 1.05] });
    const notes = [];
    if (series.length && runs.some((run) => !hasNumbers(run.ticks.error_px)))
      notes.push("Where no true error is drawn, the log holds no truth: it is from a real robot, or it is truncated.");
    if (runs.some((run) => run.target.moves))
      notes.push("The target moves, so there is no ideal exponential to compare with.");
    if (notes.length) body.append(Fovea.absent(notes.join(" ")));
    Fovea.drawn("error");
  }

  return { draw };
})();
