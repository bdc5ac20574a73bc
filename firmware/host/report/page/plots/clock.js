// SPDX-License-Identifier: Apache-2.0
// State that all drawings of a report share: the pointed-at time and the visible span of time.

Fovea.clock = (function () {
  const { listen, tell } = Fovea.callbacks();
  const clock = {
    duration: 1,
    time: null, // the shared time [s], null when nothing is pointed at
    span: [0, 1], // the visible span of time [s]
    listen,
    setTime(time, source) {
      clock.time = time === null ? null : Math.min(clock.duration, Math.max(0, time));
      tell("time", source);
    },
    setSpan(from, to) {
      const least = Math.max(0.01, clock.duration / 2000);
      let low = Math.max(0, Math.min(from, to));
      const high = Math.min(clock.duration, Math.max(from, to, low + least));
      low = Math.min(low, high - least);
      clock.span = [low, high];
      tell("span");
    },
    showAll() {
      clock.setSpan(0, clock.duration);
    },
    zoomed: () => clock.span[0] > 0 || clock.span[1] < clock.duration,
    step(share) {
      const width = clock.span[1] - clock.span[0];
      clock.setTime((clock.time === null ? clock.span[0] : clock.time) + share * width, "keys");
    },
    zoom(factor) {
      const centre = clock.time === null ? (clock.span[0] + clock.span[1]) / 2 : clock.time;
      const half = ((clock.span[1] - clock.span[0]) * factor) / 2;
      clock.setSpan(centre - half, centre + half);
    },
  };
  return clock;
})();

// The keys that every time drawing understands.
Fovea.timeKeys = function (event) {
  const clock = Fovea.clock;
  const actions = {
    ArrowLeft: () => clock.step(event.shiftKey ? -0.1 : -0.01),
    ArrowRight: () => clock.step(event.shiftKey ? 0.1 : 0.01),
    Home: () => clock.setTime(clock.span[0], "keys"),
    End: () => clock.setTime(clock.span[1], "keys"),
    "+": () => clock.zoom(0.5),
    "=": () => clock.zoom(0.5),
    "-": () => clock.zoom(2),
    Escape: () => clock.showAll(),
  };
  if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
  actions[event.key]();
  event.preventDefault();
};

// Letter of a run, as a suffix, when there are several.
Fovea.suffix = (run) => (Fovea.runs.length > 1 ? ` ${run.letter}` : "");
