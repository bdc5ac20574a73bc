// Modes, faults, lost frames and limits at work, on one axis of time; pointing at it gives words.

Fovea.timeline = (function () {
  const { el, svg, clock, words, suffix } = Fovea;

  const MODES = {
    boot: "getting ready",
    hold: "standing still and waiting",
    track: "steering to the target",
    coast: "steering on the prediction alone",
    move: "following a commanded motion",
    fault: "stopped by a fault",
  };
  const modeWords = (m) => (MODES[m.mode] || words(m.mode)) + (m.reason ? ` (${words(m.reason)})` : "");

  const spansOfModes = (run) =>
    run.modes.map((m, i) => ({
      from: m.t_s,
      to: i + 1 < run.modes.length ? run.modes[i + 1].t_s : run.duration_s,
      kind: m.mode,
      label: MODES[m.mode] ? m.mode : words(m.mode),
      say: modeWords(m),
    }));

  // Runs of pictures in which the target was not found.
  function lostSpans(run) {
    const { t_s: times, error_px: errors } = run.measured;
    if (!times || !errors) return null;
    const spans = [];
    for (let i = 0; i < times.length; i++) {
      if (Number.isFinite(errors[i])) continue;
      let end = i;
      while (end + 1 < times.length && !Number.isFinite(errors[end + 1])) end++;
      const to = end + 1 < times.length ? times[end + 1] : Math.min(run.duration_s, times[end] + 0.03);
      spans.push({
        from: times[i],
        to,
        kind: "lost",
        label: "",
        say: `target not found in ${Fovea.plural(end - i + 1, "picture")}`,
      });
      i = end;
    }
    return spans;
  }

  // All rows of the drawing: {name, spans, empty}.
  function rowsOf(runs) {
    const rows = [];
    for (const run of runs)
      rows.push({ name: "mode" + suffix(run), spans: spansOfModes(run), empty: "no modes in the log" });
    for (const run of runs) {
      rows.push({
        name: "faults" + suffix(run),
        empty: "none",
        marks: true,
        spans: run.faults.map((f) => ({
          from: f.t_s,
          to: f.t_s,
          kind: "mark",
          label: words(f.name),
          say: `fault: ${words(f.name)}${f.key ? `, setting ${f.key}` : ""}${f.detail ? `, ${f.detail}` : ""}`,
        })),
      });
    }
    for (const run of runs) {
      const spans = run.has_eye && lostSpans(run);
      if (spans) rows.push({ name: "pictures without target" + suffix(run), spans, empty: "none" });
    }
    const names = Array.from(new Set(runs.flatMap((run) => run.limits_active.map((l) => l.name)))).sort();
    for (const name of names) {
      for (const run of runs) {
        const active = run.limits_active.find((l) => l.name === name);
        const spans = ((active && active.spans) || []).map(([from, to]) => ({
          from,
          to,
          kind: "limit",
          label: "",
          say: `limit at work: ${words(name)}`,
        }));
        rows.push({ name: `limit at work: ${words(name)}${suffix(run)}`, spans, empty: "never" });
      }
    }
    return rows;
  }

  const LEFT = 52;
  const RIGHT = 12;
  const ROW = 40;

  function paint(drawing, rows, width) {
    const [from, to] = clock.span;
    const inner = width - LEFT - RIGHT;
    const x = (t) => LEFT + ((t - from) / (to - from)) * inner;
    const height = rows.length * ROW + 26;
    drawing.textContent = "";
    drawing.setAttribute("viewBox", `0 0 ${width} ${height}`);
    drawing.setAttribute("height", height);
    drawing.append(
      svg(
        "defs",
        {},
        svg(
          "pattern",
          { id: "hatch", width: 6, height: 6, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
          svg("rect", { width: 6, height: 6, class: "hatch-back" }),
          svg("rect", { width: 2.4, height: 6, class: "hatch-line" }),
        ),

        svg("clipPath", { id: "inside" }, svg("rect", { x: LEFT, y: 0, width: Math.max(1, inner), height })),
      ),
    );
    const step = Fovea.niceStep((to - from) / Math.max(4, inner / 90));
    for (let t = Math.ceil(from / step) * step; t <= to + 1e-9; t += step) {
      drawing.append(
        svg("line", { x1: x(t), x2: x(t), y1: 4, y2: height - 20, class: "grid" }),
        svg("text", { x: x(t), y: height - 5, class: "tick", "text-anchor": "middle", text: String(+t.toFixed(6)) }),
      );
    }
    const area = svg("g", { "clip-path": "url(#inside)" });
    rows.forEach((row, i) => paintRow(drawing, area, row, i * ROW, x, inner));
    drawing.append(area);
    return x;
  }

  function paintRow(drawing, area, row, top, x, inner) {
    drawing.append(svg("text", { x: LEFT, y: top + 13, class: "row-name", text: row.name }));
    const y = top + 18;
    area.append(svg("rect", { x: LEFT, y, width: inner, height: 16, rx: 2, class: "lane" }));
    if (!row.spans.length) area.append(svg("text", { x: LEFT + 6, y: y + 12, class: "none", text: row.empty }));
    for (const span of row.spans) {
      const left = Math.max(x(span.from), LEFT - 2);
      const wide = Math.max(row.marks ? 0 : 1.5, Math.min(x(span.to), LEFT + inner + 2) - left);
      if (x(span.to) < LEFT || x(span.from) > LEFT + inner) continue;
      const group = svg(
        "g",
        { class: "span " + (/^[a-z]+$/.test(span.kind) ? span.kind : "other") },
        svg("title", { text: `${span.from.toFixed(3)} s: ${span.say}` }),
      );
      if (row.marks)
        group.append(
          svg("path", { d: `M${left} ${y + 15}l-7-13h14z` }),
          svg("text", {
            x: left > LEFT + inner * 0.6 ? left - 10 : left + 10,
            y: y + 12,
            "text-anchor": left > LEFT + inner * 0.6 ? "end" : "start",
            text: span.label,
          }),
        );
      else group.append(svg("rect", { x: left, y, width: wide, height: 16, rx: 2 }));
      if (!row.marks && span.label && wide > 14 + span.label.length * 7)
        group.append(svg("text", { x: left + 6, y: y + 12, text: span.label }));
      area.append(group);
    }
  }

  // What is going on at time t, in words.
  function sayAt(runs, t) {
    return runs.map((run) => {
      const parts = [];
      const at = (spans, slack = 0) => spans.filter((s) => s.from - slack <= t && t <= s.to + slack);
      const mode = spansOfModes(run)
        .filter((s) => s.from <= t)
        .pop();
      parts.push(mode ? mode.say : "no mode");
      parts.push(...at(lostSpans(run) || []).map((s) => s.say));
      for (const limit of run.limits_active)
        if (
          at(
            (limit.spans || []).map(([from, to]) => ({ from, to })),
            0.0005,
          ).length
        )
          parts.push(`limit at work: ${words(limit.name)}`);
      for (const f of run.faults)
        if (Math.abs(f.t_s - t) < (clock.span[1] - clock.span[0]) / 80)
          parts.push(`fault: ${words(f.name)}${f.detail ? `, ${f.detail}` : ""}`);
      return (runs.length > 1 ? `Run ${run.letter}: ` : "") + parts.join("; ");
    });
  }

  function legend(runs) {
    const present = Object.keys(MODES).filter((mode) => runs.some((run) => run.modes.some((m) => m.mode === mode)));
    const swatch = (mode) =>
      svg(
        "svg",
        { viewBox: "0 0 22 12", "aria-hidden": "true" },
        svg("g", { class: "span " + mode }, svg("rect", { width: 22, height: 12, rx: 2 })),
      );
    return el(
      "ul",
      { class: "mode-legend" },
      present.map((mode) => el("li", {}, swatch(mode), el("span", { text: `${mode}: ${MODES[mode]}` }))),
    );
  }

  function asTable(run) {
    const events = run.modes
      .map((m) => [m.t_s, "mode", modeWords(m)])
      .concat(run.faults.map((f) => [f.t_s, "fault", [words(f.name), f.key, f.detail].filter(Boolean).join(", ")]))
      .sort((a, b) => a[0] - b[0]);
    if (!events.length) return null;
    return el(
      "details",
      {},
      el("summary", { text: `Modes and faults as a list${suffix(run) && ", run" + suffix(run)}` }),
      el(
        "table",
        {},
        el(
          "thead",
          {},
          el(
            "tr",
            {},
            ["Time [s]", "What", "In words"].map((text, i) =>
              el("th", { scope: "col", class: i ? "" : "number time", text }),
            ),
          ),
        ),
        el(
          "tbody",
          {},
          events.map(([t, what, say]) =>
            el(
              "tr",
              { class: what },
              el("td", { class: "number", text: t.toFixed(3) }),
              el("td", { text: what }),
              el("td", { text: say }),
            ),
          ),
        ),
      ),
    );
  }

  function draw(runs) {
    const body = document.querySelector("#timeline .body");
    const rows = rowsOf(runs);
    if (!rows.some((row) => row.spans.length)) {
      body.append(Fovea.absent("The log holds no modes, no faults and no limits at work."));
      return Fovea.drawn("timeline");
    }
    const drawing = svg("svg", {
      class: "timeline-svg",
      role: "img",
      "aria-label": "Modes, faults, lost pictures and active limits over time; the same is given as a list beneath",
    });
    const cursor = el("div", { class: "cursor", hidden: true });
    const brush = el("div", { class: "brush", hidden: true });
    const frame = el(
      "div",
      {
        class: "timeline-frame",
        tabindex: "0",
        role: "group",
        onkeydown: Fovea.timeKeys,
        "aria-label": "Events over time. Arrow keys move the time, plus and minus zoom, Escape shows everything.",
      },
      drawing,
      cursor,
      brush,
    );
    const said = el("div", { class: "said" });
    body.append(
      el("div", { class: "toolbar" }, Fovea.zoomBar()),
      el("figure", { class: "plot" }, frame, el("p", { class: "axis-x", text: "time [s]" }), legend(runs), said),
    );
    let x = null;
    const move = () => {
      const shown = x && clock.time !== null && clock.time >= clock.span[0] && clock.time <= clock.span[1];
      cursor.hidden = !shown;
      if (shown) cursor.style.left = `${x(clock.time)}px`;
      said.textContent = "";
      const lines =
        clock.time === null
          ? ["Point at the drawing, or move the time with the arrow keys, to read in words what was going on."]
          : sayAt(runs, clock.time);
      if (clock.time !== null) said.append(el("strong", { text: `At ${clock.time.toFixed(3)} s` }));
      said.append(...lines.map((text) => el("p", { text })));
    };
    const repaint = () => {
      x = paint(drawing, rows, Math.max(240, frame.clientWidth));
      move();
    };
    const timeAt = (px) =>
      clock.span[0] + ((px - LEFT) / Math.max(1, frame.clientWidth - LEFT - RIGHT)) * (clock.span[1] - clock.span[0]);
    Fovea.pointer(frame, brush, timeAt);
    repaint();
    clock.listen((what) => (what === "time" ? move() : repaint()));
    Fovea.theme.listen(repaint);
    addEventListener("resize", repaint);
    runs.forEach((run) => {
      const list = asTable(run);
      if (list) body.append(list);
    });
    if (!runs.some((run) => run.limits_active.length))
      body.append(Fovea.absent("The log names no limit that was at work."));
    Fovea.drawn("timeline");
  }

  return { draw };
})();

// 1, 2 or 5 times a power of ten, not below `least`.
Fovea.niceStep = function (least) {
  const power = Math.pow(10, Math.floor(Math.log10(least)));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= least * 0.999);
};
