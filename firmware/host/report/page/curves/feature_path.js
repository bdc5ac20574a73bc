// SPDX-License-Identifier: Apache-2.0
// The path of the features in the picture: v over u, axes as large as the picture; start, end and goal marked.

Fovea.featurePath = (function () {
  const { el, svg, clock, number, fixed, suffix } = Fovea;
  const COLOURS = ["--blue", "--vermillion", "--green", "--purple"];
  const LEFT = 46;
  const BELOW = 34;
  const MARGIN = 12;

  // The points of a run's features: {name, colour, goal: [u, v], at: i -> [u, v]}, and their times.
  function pointsOf(run) {
    const path = run.feature_path;
    const size = path.goal_px.length;
    return Array.from({ length: size / 2 }, (_, k) => ({
      name: size > 2 ? `corner ${k + 1}` : `centre of the ${Fovea.targetWord(run)}`,
      colour: COLOURS[k % COLOURS.length],
      goal: [path.goal_px[2 * k], path.goal_px[2 * k + 1]],
      at: (i) => [path.px[i * size + 2 * k], path.px[i * size + 2 * k + 1]],
    }));
  }

  const isSeen = (p) => Number.isFinite(p[0] + p[1]);

  // The first and the last frame in which a point was found.
  function ends(run, point) {
    const frames = Array.from(run.feature_path.t_s.keys()).filter((i) => isSeen(point.at(i)));
    return frames.length ? [point.at(frames[0]), point.at(frames[frames.length - 1])] : null;
  }

  // Distance to the nearest goal of any corner: the picture does not tell which corner is the first.
  function offGoal(run, points, end) {
    return Math.min(...points.map((p) => Math.hypot(p.goal[0] - end[0], p.goal[1] - end[1])));
  }

  function drawn(run, point, scale) {
    let path = "";
    let pen = "M";
    for (let i = 0; i < run.feature_path.t_s.length; i++) {
      const p = point.at(i);
      if (isSeen(p)) path += `${pen}${scale.x(p[0]).toFixed(2)} ${scale.y(p[1]).toFixed(2)}`;
      pen = isSeen(p) ? "L" : "M";
    }
    return svg("path", {
      d: path,
      class: "feature-line",
      style: `stroke:var(${point.colour})`,
      "stroke-dasharray": run.index ? "7 4" : null,
    });
  }

  function mark(kind, p, scale, colour) {
    const x = scale.x(p[0]);
    const y = scale.y(p[1]);
    const style = `color:var(${colour})`;
    if (kind === "start") return svg("circle", { cx: x, cy: y, r: 5, class: "feature-start", style });
    if (kind === "end")
      return svg("rect", { x: x - 4.5, y: y - 4.5, width: 9, height: 9, class: "feature-end", style });
    return svg("path", { d: `M${x - 9} ${y}h18M${x} ${y - 9}v18`, class: "feature-goal" });
  }

  function axes(drawing, scale, width_px, height_px) {
    const text = (x, y, words, anchor) =>
      drawing.append(svg("text", { x, y, class: "tick", "text-anchor": anchor, text: words }));
    const step = Fovea.niceStep(width_px / Math.max(3, scale.width / 90));
    for (let u = 0; u <= width_px; u += step) {
      drawing.append(
        svg("line", { x1: scale.x(u), x2: scale.x(u), y1: scale.y(0), y2: scale.y(height_px), class: "grid" }),
      );
      text(scale.x(u), scale.y(height_px) + 16, String(u), "middle");
    }
    for (let v = 0; v <= height_px; v += step) {
      drawing.append(
        svg("line", { x1: scale.x(0), x2: scale.x(width_px), y1: scale.y(v), y2: scale.y(v), class: "grid" }),
      );
      text(LEFT - 6, scale.y(v) + 4, String(v), "end");
    }
    drawing.append(
      svg("rect", {
        x: scale.x(0),
        y: scale.y(0),
        width: scale.width,
        height: scale.y(height_px) - scale.y(0),
        class: "feature-edge",
      }),
    );
    text(scale.x(width_px), scale.y(height_px) + 30, "u [px]", "end");
    text(6, 12, "v [px]", "start");
  }

  function paint(drawing, runs, width) {
    const { width_px, height_px } = runs[0];
    const inner = Math.min(width - LEFT - MARGIN, 720);
    const k = inner / width_px;
    const scale = { width: inner, x: (u) => LEFT + k * u, y: (v) => MARGIN + 8 + k * v };
    const high = scale.y(height_px) + BELOW;
    drawing.textContent = "";
    drawing.setAttribute("viewBox", `0 0 ${LEFT + inner + MARGIN} ${high}`);
    drawing.setAttribute("width", LEFT + inner + MARGIN);
    drawing.setAttribute("height", high);
    axes(drawing, scale, width_px, height_px);
    const dots = [];
    const marks = svg("g");
    for (const run of runs) {
      for (const point of pointsOf(run)) {
        drawing.append(drawn(run, point, scale));
        const found = ends(run, point);
        if (isSeen(point.goal)) marks.append(mark("goal", point.goal, scale, point.colour));
        if (found)
          marks.append(mark("start", found[0], scale, point.colour), mark("end", found[1], scale, point.colour));
        const dot = svg("circle", { r: 3.5, class: "feature-now", visibility: "hidden" });
        dots.push({ run, point, dot });
      }
    }
    drawing.append(marks, ...dots.map(({ dot }) => dot));
    return () => {
      for (const { run, point, dot } of dots) {
        const i = clock.time === null ? -1 : Fovea.indexAt(run.feature_path.t_s, clock.time);
        const p = i >= 0 ? point.at(i) : [NaN, NaN];
        dot.setAttribute("visibility", isSeen(p) ? "visible" : "hidden");
        if (!isSeen(p)) continue;
        dot.setAttribute("cx", scale.x(p[0]));
        dot.setAttribute("cy", scale.y(p[1]));
      }
    };
  }

  function legend(runs) {
    const box = (...children) =>
      svg("svg", { viewBox: "0 0 26 14", class: "swatch feature-key", "aria-hidden": "true" }, children);
    const at = { x: () => 13, y: () => 7 };
    const items = pointsOf(runs[0]).map((point) =>
      el(
        "li",
        {},
        box(svg("path", { d: "M1 7H25", class: "feature-line", style: `stroke:var(${point.colour})` })),
        el("span", { text: point.name }),
      ),
    );
    for (const [kind, words] of [
      ["start", "start"],
      ["end", "end"],
      ["goal", "goal"],
    ])
      items.push(el("li", {}, box(mark(kind, [0, 0], at, "--ink")), el("span", { text: words })));
    if (runs.length > 1) items.push(el("li", { class: "rule", text: "A solid, B dashed" }));
    return el("ul", { class: "legend plain" }, items);
  }

  // A table of start, end and goal.
  function table(run) {
    const points = pointsOf(run);
    const pair = (p) => (p && isSeen(p) ? `${fixed(p[0], 1)}, ${fixed(p[1], 1)}` : "–");
    const rows = points.map((point) => {
      const found = ends(run, point);
      const off = found ? number(offGoal(run, points, found[1]), 2) : "–";
      return [point.name + suffix(run), pair(found && found[0]), pair(found && found[1]), pair(point.goal), off];
    });
    const heads = ["Feature", "Start u, v [px]", "End u, v [px]", "Goal u, v [px]", "End to goal [px]"];
    return Fovea.table(heads, rows, { number: (i) => i > 0, scroll: true });
  }

  function draw(runs) {
    const body = document.querySelector("#features .body");
    const shown = runs.filter(
      (run) => run.feature_path && run.width_px > 0 && run.height_px > 0 && pointsOf(run).some((p) => ends(run, p)),
    );
    if (!shown.length) {
      body.append(Fovea.absent("The log holds no position of the target in the picture."));
      return Fovea.drawn("features");
    }
    const drawing = svg("svg", {
      class: "feature-svg",
      role: "img",
      "aria-label": "Path of the features in the picture; start, end and goal are given in the table beneath",
    });
    const frame = el("div", {}, drawing);
    body.append(
      el("figure", { class: "plot" }, frame, legend(shown)),
      el("p", {
        class: "hint",
        text: "Measured by the detector, frame by frame, in pixels of a lens without distortion. The dot marks the feature at the shared time.",
      }),
      ...shown.map(table),
    );
    let move = null;
    const repaint = () => {
      move = paint(drawing, shown, Math.max(240, frame.clientWidth));
      move();
    };
    repaint();
    clock.listen(() => move());
    addEventListener("resize", repaint);
    Fovea.theme.listen(repaint);
    Fovea.drawn("features");
  }

  return { draw };
})();
