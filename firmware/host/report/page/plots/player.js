// SPDX-License-Identifier: Apache-2.0
// The slider and the play button that move the shared time.

Fovea.player = function () {
  const { el, clock } = Fovea;
  const slider = el("input", {
    type: "range",
    min: 0,
    max: clock.duration,
    step: clock.duration / 2000,
    value: 0,
    "aria-label": "Time of the shown pose, in seconds",
  });
  const shown = el("output", { class: "now" });
  const play = el("button", { type: "button", class: "play", text: "▶ Play" });
  let last = null;
  const step = (stamp) => {
    if (last === null) return;
    const t = (clock.time || 0) + (stamp - last) / 1000;
    last = stamp;
    clock.setTime(t, "player");
    if (t >= clock.duration) stop();
    else requestAnimationFrame(step);
  };
  const stop = () => {
    last = null;
    play.textContent = "▶ Play";
  };
  play.addEventListener("click", () => {
    if (last !== null) return stop();
    if (clock.time === null || clock.time >= clock.duration - 1e-6) clock.setTime(0, "player");
    last = performance.now();
    play.textContent = "❚❚ Pause";
    requestAnimationFrame(step);
  });
  slider.addEventListener("input", () => {
    stop();
    clock.setTime(Number(slider.value), "slider");
  });
  const show = (t) => {
    slider.value = t;
    shown.textContent = `${t.toFixed(3)} s`;
  };
  return { node: el("div", { class: "player no-print" }, play, slider, shown), show, stop };
};
