// SPDX-License-Identifier: Apache-2.0
// The head of the page: a verdict for each run, and the figures behind it.

Fovea.verdict = (function () {
  const { el, svg, number, words, plural } = Fovea;

  const MARKS = {
    good: "M5 12.5 10 17.5 19 7",
    bad: "M6.5 6.5 17.5 17.5 M17.5 6.5 6.5 17.5",
    warn: "M12 5 12 13.5 M12 17.6 12 18",
  };

  function judge(run) {
    const summary = run.summary;
    if (!summary) {
      const end = number(run.duration_s, 3);
      return {
        kind: "warn",
        word: "No verdict",
        sentence: `The log is truncated: it ends at ${end} s and holds no summary.`,
      };
    }
    const faults = (summary.faults || run.faults).length;
    const violations = summary.limit_violations || 0;
    const troubles = [];
    if (faults) troubles.push(plural(faults, "fault"));
    if (violations) troubles.push(plural(violations, "limit violation"));
    const sentence = summary.verdict ? sentenceCase(summary.verdict) : "The log gives no verdict.";
    if (summary.converged === true && !troubles.length) return { kind: "good", word: "Good", sentence };
    if (summary.converged === true)
      return { kind: "warn", word: "With problems", sentence: `${sentence} But: ${troubles.join(", ")}.` };
    if (summary.converged === false) return { kind: "bad", word: "Not good", sentence };
    return { kind: "warn", word: "No verdict", sentence };
  }

  function sentenceCase(text) {
    const sentence = text.charAt(0).toUpperCase() + text.slice(1);
    return /[.!?]$/.test(sentence) ? sentence : sentence + ".";
  }

  // The figures of a run: {key, label, value, unit, note, digits, better: 'low' | 'high' | null}.
  function figures(run) {
    const s = run.summary;
    if (!s) return figuresFromLog(run);
    const list = [];
    const add = (key, label, value, unit, more) => {
      if (value === null || value === undefined) return;
      list.push(Object.assign({ key, label, value, unit, note: "", better: "low" }, more));
    };
    add("error_px", "Final image error", s.final_error_px_rms, "px", {
      note: Number.isFinite(s.start_error_px) ? `rms, from ${number(s.start_error_px)} px at the start` : "rms",
    });
    add("error_mm", "Final position error", s.final_error_mm, "mm", { note: splitNote(s) });
    if (s.camera) add("seen_px", "Last measured image error", s.camera.seen_error_px, "px", { note: "by the camera" });
    add("sideways", "Final position error, sideways", s.final_error_lateral_mm, "mm", { onlyTable: true });
    add("depth", "Final position error, in depth", s.final_error_depth_mm, "mm", { onlyTable: true });
    add("angle", "Final angle error", s.final_error_deg, "°");
    add("tracking", "Tracking error", s.tracking_error_px_rms, "px", { note: "rms while the target moves" });
    if (!run.target.moves)
      add("settle", "Settling time", s.settle_time_s, "s", { note: "until the error stays small" });
    add("violations", "Limit violations", s.limit_violations, "", { note: mostUsed(s.limits), count: true });
    add("faults", "Faults", (s.faults || run.faults).length, "", {
      note: (s.faults || run.faults).map((f) => words(f.name)).join(", ") || "none",
      count: true,
    });
    list.push(...frameFigures(run));
    if (s.robot)
      add("states", "States lost", s.robot.lost_states, "", { note: `of ${s.robot.states} of the robot`, count: true });
    add("overruns", "Overruns of the tick", s.overruns, "", {
      note: Number.isFinite(s.ticks)
        ? `in ${s.ticks} ticks, ${s.missed_ticks || 0} missed${Fovea.ticks.isLockstep(run) ? "; in lockstep the simulated clock waits for the servo, so that no tick can overrun" : ""}`
        : "",
      count: true,
    });
    add("heap", "Heap calls in the tick", s.heap_allocations_in_tick, "", { note: "should be none", count: true });
    add("speed", "Speed", s.real_time_factor, "× real time", {
      better: null,
      note: Number.isFinite(s.wall_time_s) ? `${number(s.sim_time_s)} s simulated in ${number(s.wall_time_s)} s` : "",
    });
    return list;
  }

  // Counted from the log's spans, like the time axis, so that the two never contradict each other.
  function frameFigures(run) {
    if (!run.has_eye || !Number.isFinite(run.frames_taken)) return [];
    const placed = Fovea.frameCount(run.lost);
    const counted = run.summary ? run.summary.frames_lost || 0 : 0;
    const more = counted > placed ? `; the log gives the time of ${placed} of them` : "";
    const of = `of ${Fovea.plural(run.frames_taken, "frame")} that reached the servo`;
    const figure = { unit: "", count: true, better: "low" };
    return [
      {
        key: "lost",
        label: "Frames lost",
        value: Math.max(placed, counted),
        note: `never reached the servo; ${run.frames_taken} did${more}`,
        ...figure,
      },
      {
        key: "not_found",
        label: "Frames without target",
        value: Fovea.frameCount(run.not_found),
        note: of,
        ...figure,
      },
    ];
  }

  // The figures from the log itself, for a run without summary.
  function figuresFromLog(run) {
    const list = [];
    const last = (times, values) => {
      for (let i = values ? values.length - 1 : -1; i >= 0; i--)
        if (Number.isFinite(values[i])) return { value: values[i], t: times[i] };
      return null;
    };
    const error = last(run.ticks.t_s, run.ticks.error_px) || last(run.measured.t_s, run.measured.error_px);
    if (error)
      list.push({
        key: "error_px",
        label: "Last image error",
        value: error.value,
        unit: "px",
        note: `at ${number(error.t)} s, in the log`,
        better: "low",
      });
    list.push({
      key: "faults",
      label: "Faults",
      value: run.faults.length,
      unit: "",
      count: true,
      better: "low",
      note: run.faults.map((f) => words(f.name)).join(", ") || "none in the log",
    });
    list.push(...frameFigures(run));
    list.push({ key: "length", label: "Length of the log", value: run.duration_s, unit: "s", note: "", better: null });
    return list;
  }

  function splitNote(s) {
    if (!Number.isFinite(s.final_error_lateral_mm) || !Number.isFinite(s.final_error_depth_mm)) return "";
    return `${number(s.final_error_lateral_mm, 2)} mm sideways, ${number(s.final_error_depth_mm, 2)} mm in depth`;
  }

  function mostUsed(limits) {
    const top = Object.entries(limits || {}).sort((a, b) => b[1] - a[1])[0];
    return top ? `most used: ${words(top[0])}, ${Fovea.limits.percent(top[1])} ${Fovea.limits.ofWhat(top[0])}` : "";
  }

  function show(figure) {
    return figure.count ? String(figure.value) : number(figure.value, 3);
  }

  function banner(run, several) {
    const { kind, word, sentence } = judge(run);
    const mark = svg(
      "svg",
      { viewBox: "0 0 24 24", class: "mark", "aria-hidden": "true" },
      svg("circle", { cx: 12, cy: 12, r: 11.2 }),
      svg("path", { d: MARKS[kind] }),
    );
    const text = el(
      "div",
      {},
      several ? el("p", { class: "run-tag", text: `Run ${run.letter}: ${run.name}` }) : null,
      el("p", { class: "verdict-word", text: word }),
      el("p", { class: "verdict-sentence", text: sentence }),
    );
    return el("div", { class: `banner ${kind}` }, mark, text);
  }

  function tiles(run) {
    const alarming = (f) => f.count && f.value > 0 && !["lost", "not_found"].includes(f.key);
    return el(
      "dl",
      { class: "tiles" },
      figures(run)
        .filter((f) => !f.onlyTable)
        .map((f) =>
          el(
            "div",
            { class: alarming(f) ? "tile alarm" : "tile" },
            el("dt", { text: f.label }),
            el(
              "dd",
              {},
              el("span", { class: "value", text: show(f) }),
              f.unit ? el("span", { class: "unit", text: " " + f.unit }) : null,
              f.note ? el("span", { class: "note", text: f.note }) : null,
            ),
          ),
        ),
    );
  }

  function heading(runs) {
    const title = document.getElementById("title");
    title.textContent =
      runs.length > 1
        ? runs[0].name === runs[1].name
          ? `${runs[0].name}: two runs side by side`
          : `${runs[0].name} and ${runs[1].name}, side by side`
        : runs[0].name;
    const facts = (run) => {
      const s = run.summary || {};
      const parts = [
        run.info.robot ? `robot ${run.info.robot}` : null,
        `${number(run.duration_s)} s`,
        run.lambda && run.has_eye ? `gain λ = ${number(run.lambda, 2)} 1/s` : null,
        s.pace ? `pace ${s.pace}` : null,
        Number.isFinite(s.seed) ? `seed ${s.seed}` : null,
        run.source ? `from ${run.source}` : null,
      ];
      return parts.filter(Boolean).join(" · ");
    };
    document
      .getElementById("subtitle")
      .append(
        ...runs.map((run) => el("span", { text: runs.length > 1 ? `${run.letter}: ${facts(run)}` : facts(run) })),
      );
  }

  function draw(runs) {
    heading(runs);
    const section = document.getElementById("verdict");
    const several = runs.length > 1;
    section.append(el("h2", { class: "unseen", text: "Verdict" }));
    section.append(
      el(
        "div",
        { class: several ? "columns" : "" },
        runs.map((run) => banner(run, several)),
      ),
    );
    section.append(several ? Fovea.compare.table(runs) : tiles(runs[0]));
    Fovea.drawn("verdict");
  }

  return { draw, figures, show };
})();
