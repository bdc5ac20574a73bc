// SPDX-License-Identifier: Apache-2.0
// Modes, faults, the operator's changes, lost frames and active limits on one time axis; pointing at it shows a description.

Fovea.timeline = (function () {
  const { el, svg, clock, words, suffix } = Fovea;

  const { rowsOf, isQuiet, sayAt, modeSay } = Fovea.timelineRows;

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

  function asTable(run) {
    const events = run.modes
      .map((m) => [m.t_s, "mode", modeSay(m)])
      .concat(run.ways.map((w) => [w.t_s, "way", w.why || words(w.way)]))
      .concat(run.faults.map((f) => [f.t_s, "fault", [words(f.name), f.key, f.detail].filter(Boolean).join(", ")]))
      .concat(run.operator.map((o) => [o.t_s, "operator", o.words]))
      .concat(Fovea.bands.injectedOf(run).map((f) => [f.from, "injected", `${f.name}, until ${f.to.toFixed(3)} s`]))
      .sort((a, b) => a[0] - b[0]);
    if (!events.length) return null;
    return el(
      "details",
      {},
      el("summary", { text: `Modes, faults and changes as a list${suffix(run) && ", run" + suffix(run)}` }),
      Fovea.table(
        [{ class: "time", of: "Time [s]" }, "Kind", "Description"],
        events.map(([t, what, say]) => ({ class: what, cells: [t.toFixed(3), what, say] })),
        { number: (i) => i === 0, named: false },
      ),
    );
  }

  // One line for all rows without an event, and a button that shows them.
  function foldLine(quiet, onChange) {
    const limits = quiet.filter((row) => row.limit).map((row) => row.limit);
    const others = quiet.filter((row) => !row.limit).map((row) => `${row.name}: ${row.empty}`);
    const parts = limits.length ? [...others, `never active: ${limits.join(", ")}`] : others;
    const words = (on) => (on ? "Fold these rows" : `Show ${Fovea.plural(quiet.length, "more row")}`);
    const button = el("button", { type: "button", class: "no-print", "aria-expanded": "false", text: words(false) });
    button.addEventListener("click", () => {
      const on = button.getAttribute("aria-expanded") !== "true";
      button.setAttribute("aria-expanded", String(on));
      button.textContent = words(on);
      onChange(on);
    });
    return el("div", { class: "quiet-rows" }, el("p", { text: `${parts.join("; ")}.` }), button);
  }

  function draw(runs) {
    const body = document.querySelector("#timeline .body");
    const rows = rowsOf(runs);
    const quiet = rows.filter(isQuiet);
    let unfolded = false;
    const shownRows = () => (unfolded ? rows : rows.filter((row) => !isQuiet(row)));
    if (quiet.length === rows.length) {
      body.append(Fovea.absent("The log holds no modes, no faults and no active limits."));
      return Fovea.drawn("timeline");
    }
    const drawing = svg("svg", {
      class: "timeline-svg",
      role: "img",
      "aria-label": "Modes, faults, lost pictures and active limits over time; the list below gives the same",
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
      el(
        "figure",
        { class: "plot" },
        frame,
        el("p", { class: "axis-x", text: "time [s]" }),
        quiet.length
          ? foldLine(quiet, (on) => {
              unfolded = on;
              repaint();
            })
          : null,
        Fovea.bands.legend(runs),
        said,
      ),
    );
    let x = null;
    const move = () => {
      const shown = x && clock.time !== null && clock.time >= clock.span[0] && clock.time <= clock.span[1];
      cursor.hidden = !shown;
      if (shown) cursor.style.left = `${x(clock.time)}px`;
      said.textContent = "";
      const lines =
        clock.time === null
          ? ["Point at the drawing, or move the time with the arrow keys, to read what happened at a time."]
          : sayAt(runs, clock.time);
      if (clock.time !== null) said.append(el("strong", { text: `At ${clock.time.toFixed(3)} s` }));
      said.append(...lines.map((text) => el("p", { text })));
    };
    const repaint = () => {
      x = paint(drawing, shownRows(), Math.max(240, frame.clientWidth));
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
    if (!runs.some((run) => run.limits_active.length)) body.append(Fovea.absent("The log names no active limit."));
    Fovea.drawn("timeline");
  }

  return { draw };
})();

// 1, 2 or 5 times a power of ten, not below `least`.
Fovea.niceStep = function (least) {
  const power = Math.pow(10, Math.floor(Math.log10(least)));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= least * 0.999);
};
