// SPDX-License-Identifier: Apache-2.0
// The outlines that are drawn into the camera's pictures: what each means, and its entry in a legend.

Fovea.ROLES = {
  goal: "goal: where the target should be",
  detection: "detection: what the detector found",
  truth: "truth: where the target was",
};

Fovea.roleItem = function (role) {
  const { el, svg } = Fovea;
  const swatch = svg(
    "svg",
    { viewBox: "0 0 26 12", class: "swatch outline " + role, "aria-hidden": "true" },
    svg("rect", { x: 0, y: 0, width: 26, height: 12, class: "dark" }),
    svg("path", { d: "M2 6H24" }),
  );
  return el("li", {}, swatch, el("span", { text: Fovea.ROLES[role] }));
};
