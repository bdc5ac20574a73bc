// SPDX-License-Identifier: Apache-2.0
// The outlines that are drawn into the camera's pictures: what each means, and its entry in a legend. A short entry has
// the meaning as a tooltip.

Fovea.ROLES = {
  goal: "goal: where the target should be",
  detection: "detection: what the detector found",
  truth: "truth: where the target was",
};

Fovea.roleItem = function (role, short = false) {
  const { el, svg } = Fovea;
  const swatch = svg(
    "svg",
    { viewBox: "0 0 26 12", class: "swatch outline " + role, "aria-hidden": "true" },
    svg("rect", { x: 0, y: 0, width: 26, height: 12, class: "dark" }),
    svg("path", { d: "M2 6H24" }),
  );
  const text = Fovea.ROLES[role];
  return el("li", { title: short ? text : null }, swatch, el("span", { text: short ? role : text }));
};
