// SPDX-License-Identifier: Apache-2.0
// How a pointer, and buttons, move and zoom the shared time on a drawing.

// Pointing moves the shared time, dragging with a mouse zooms, double-click shows everything.
// A finger moves the time sideways and still scrolls the page up and down (touch-action: pan-y).
Fovea.pointer = function (glass, brush, timeAt) {
  const clock = Fovea.clock;
  let start = null;
  const xOf = (event) => event.clientX - glass.getBoundingClientRect().left;
  glass.addEventListener("pointerdown", (event) => {
    clock.setTime(timeAt(xOf(event)), "plot");
    if (event.pointerType === "touch" || event.button !== 0) return;
    start = xOf(event);
    glass.setPointerCapture(event.pointerId);
  });
  glass.addEventListener("pointermove", (event) => {
    const x = xOf(event);
    clock.setTime(timeAt(x), "plot");
    if (start === null) return;
    const left = Math.max(0, Math.min(start, x));
    brush.hidden = Math.abs(x - start) < 4;
    brush.style.left = `${left}px`;
    brush.style.width = `${Math.min(glass.clientWidth, Math.max(start, x)) - left}px`;
  });
  glass.addEventListener("pointerup", (event) => {
    if (start === null) return;
    const x = xOf(event);
    if (Math.abs(x - start) >= 4) clock.setSpan(timeAt(start), timeAt(x));
    start = null;
    brush.hidden = true;
  });
  glass.addEventListener("pointercancel", () => {
    start = null;
    brush.hidden = true;
  });
  glass.addEventListener("dblclick", () => clock.showAll());
};

// Buttons that zoom the shared span of time, for fingers and keys.
Fovea.zoomBar = function () {
  const { el, clock } = Fovea;
  const all = el("button", { type: "button", text: "Whole run", onclick: () => clock.showAll() });
  const show = () => {
    all.disabled = !clock.zoomed();
  };
  clock.listen(show);
  show();
  return el(
    "div",
    { class: "choice", role: "group", "aria-label": "Zoom in time" },
    el("button", { type: "button", text: "−", "aria-label": "Zoom out in time", onclick: () => clock.zoom(2) }),
    el("button", { type: "button", text: "+", "aria-label": "Zoom in in time", onclick: () => clock.zoom(0.5) }),
    all,
  );
};
