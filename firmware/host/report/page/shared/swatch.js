// SPDX-License-Identifier: Apache-2.0
// Samples of curves, for legends. A curve: {colour, dots, dash, run}; the second run's curves are dashed or hollow.

Fovea.dashOf = (s) => s.dash || (s.run && !s.dots ? [7, 4] : null);

// A sample of each of the given series, one below the other.
Fovea.swatch = function (...list) {
  const box = Fovea.svg("svg", {
    viewBox: "0 0 26 12",
    class: "swatch",
    "aria-hidden": "true",
    style: `color:var(${list[0].colour})`,
  });
  list.forEach((s, k) => {
    const y = list.length > 1 ? 3 + 6 * k : 6;
    const r = list.length > 1 ? 1.9 : 2.2;
    if (s.dots)
      for (const x of [5, 13, 21])
        box.append(
          Fovea.svg("circle", { cx: x, cy: y, r, fill: s.run ? "none" : "currentColor", stroke: "currentColor" }),
        );
    else
      box.append(
        Fovea.svg("line", {
          x1: 1,
          x2: 25,
          y1: y,
          y2: y,
          stroke: "currentColor",
          "stroke-width": 2.4,
          "stroke-dasharray": (Fovea.dashOf(s) || []).join(" ") || null,
        }),
      );
  });
  return box;
};
