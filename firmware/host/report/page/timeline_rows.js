// SPDX-License-Identifier: Apache-2.0
// The rows of the time axis: modes, faults, injected faults, the operator's changes, frames and limits; and a description of one time.

Fovea.timelineRows = (function () {
  const { clock, words, suffix, MODES, modeWords } = Fovea;
  const { modesOf, injectedOf } = Fovea.bands;

  const modeSay = (m) => modeWords(m.mode) + (m.reason ? ` (${words(m.reason)})` : "");

  const spansOfModes = (run) =>
    modesOf(run).map((m) => ({
      from: m.from,
      to: m.to,
      kind: m.mode,
      label: MODES[m.mode] ? m.mode : words(m.mode),
      say: modeSay(m),
    }));

  // The parts of the way to the target that are not the visual law's. The colours are those of modes in which the arm
  // stands, and follows a commanded motion.
  const WAYS = {
    await_plan: { kind: "hold", label: "awaits a plan" },
    plan: { kind: "move", label: "follows a plan" },
  };
  const spansOfWays = (run) =>
    run.ways.flatMap((change, i) => {
      const to = i + 1 < run.ways.length ? run.ways[i + 1].t_s : run.duration_s;
      const way = WAYS[change.way];
      const why = change.why ? ` (${change.why})` : "";
      return way ? [{ from: change.t_s, to, ...way, say: `the arm ${way.label}${why}` }] : [];
    });

  const spansOfInjected = (run) =>
    injectedOf(run).map((f) => ({
      from: f.from,
      to: f.to,
      kind: "injected",
      label: f.name,
      say: `injected fault: ${f.name}, from ${f.from.toFixed(3)} to ${f.to.toFixed(3)} s`,
    }));

  const spansOfFrames = (spans, say) =>
    spans.map((span) => ({
      from: span.from_s,
      to: Math.max(span.to_s, span.from_s + 0.005),
      kind: "lost",
      label: "",
      say: `${say} ${Fovea.plural(span.frames, "frame")}`,
    }));
  const spansOfLost = (run) => spansOfFrames(run.lost, "lost before the servo:");
  const spansOfNotFound = (run) => spansOfFrames(run.not_found, "target not found in");

  const spansOfLimit = (run, name) => {
    const active = run.limits_active.find((l) => l.name === name);
    return ((active && active.spans) || []).map(([from, to]) => ({
      from,
      to,
      kind: "limit",
      label: "",
      say: `active limit: ${words(name)}`,
    }));
  };

  // All rows of the drawing: {name, spans, empty, marks, limit}.
  function rowsOf(runs) {
    const rows = [];
    const add = (name, of, more) =>
      runs.forEach((run) => rows.push({ name: name + suffix(run), spans: of(run), empty: "none", ...more }));
    add("mode", spansOfModes, { empty: "not in the log" });
    add("way to the target", spansOfWays, { empty: "by the visual law alone" });
    for (const run of runs) {
      const names = Array.from(new Set(injectedOf(run).map((f) => f.name))).join(", ");
      rows.push({
        name: `injected faults${suffix(run)}${names && `: ${names}`}`,
        spans: spansOfInjected(run),
        empty: "none",
      });
    }
    const faults = (run) =>
      run.faults.map((f) => ({
        from: f.t_s,
        to: f.t_s,
        kind: "mark",
        label: words(f.name),
        say: `fault: ${words(f.name)}${f.key ? `, setting ${f.key}` : ""}${f.detail ? `, ${f.detail}` : ""}`,
      }));
    add("faults", faults, { marks: true });
    const operator = (run) =>
      run.operator.map((o) => ({ from: o.t_s, to: o.t_s, kind: o.kind, label: o.words, say: o.words }));
    if (runs.some((run) => run.operator.length)) add("what the operator did", operator, { marks: true });
    for (const run of runs.filter((run) => run.has_eye))
      rows.push(
        { name: "frames lost" + suffix(run), spans: spansOfLost(run), empty: "none" },
        { name: "frames without target" + suffix(run), spans: spansOfNotFound(run), empty: "none" },
      );
    const names = Array.from(new Set(runs.flatMap((run) => run.limits_active.map((l) => l.name)))).sort();
    for (const name of names)
      runs.forEach((run) =>
        rows.push({
          name: `active limit: ${words(name)}${suffix(run)}`,
          limit: words(name) + suffix(run),
          spans: spansOfLimit(run, name),
          empty: "never",
        }),
      );
    return rows;
  }

  const isQuiet = (row) => !row.spans.length;

  // A description of time t, a line for each run.
  function sayAt(runs, t) {
    return runs.map((run) => {
      const at = (spans, slack = 0) => spans.filter((s) => s.from - slack <= t && t <= s.to + slack).map((s) => s.say);
      const mode = spansOfModes(run)
        .filter((s) => s.from <= t)
        .pop();
      const parts = [
        mode ? mode.say : "no mode",
        ...at(spansOfWays(run)),
        ...at(spansOfInjected(run)),
        ...at(spansOfLost(run)),
        ...at(spansOfNotFound(run)),
        ...run.limits_active.flatMap((limit) => at(spansOfLimit(run, limit.name), 0.0005).slice(0, 1)),
      ];
      for (const f of run.faults)
        if (Math.abs(f.t_s - t) < (clock.span[1] - clock.span[0]) / 80)
          parts.push(`fault: ${words(f.name)}${f.detail ? `, ${f.detail}` : ""}`);
      for (const did of run.operator)
        if (Math.abs(did.t_s - t) < (clock.span[1] - clock.span[0]) / 80) parts.push(did.words);
      return (runs.length > 1 ? `Run ${run.letter}: ` : "") + parts.join("; ");
    });
  }

  return { rowsOf, isQuiet, sayAt, modeSay };
})();
