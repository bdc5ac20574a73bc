// SPDX-License-Identifier: Apache-2.0
// Compares a replay with other settings to the recorded run: the commands of both over time.

(function () {
  const { el, plots } = Fovea;
  const body = (id) => document.querySelector(`#${id} .body`);

  function readRuns() {
    return Array.from(document.querySelectorAll("script.fovea-run")).map((node, index) =>
      Object.assign(JSON.parse(node.textContent), { index, letter: "AB"[index] }),
    );
  }

  // One line for each run.
  function pair(name, colour, pick) {
    return Fovea.runs.map((run) => ({ name, run: run.index, colour, width: 1.8, t: run.t_s, v: pick(run) }));
  }

  function plot(host, label, series, more) {
    plots.create(host, Object.assign({ label, series, includeZero: true, height: 220 }, more));
  }

  function ofJoints(key) {
    return Fovea.runs.flatMap((run) =>
      run[key].map((values, i) => ({
        name: `joint ${i + 1}`,
        tag: run.index ? null : String(i + 1),
        run: run.index,
        colour: `--joint-${i + 1}`,
        width: 1.5,
        t: run.t_s,
        v: values,
      })),
    );
  }

  // The columns `words` are text, the others numbers.
  function table(heads, words, rows) {
    return Fovea.table(heads, rows, { number: (i) => !words.includes(i), named: false, scroll: true });
  }

  function draw() {
    const [recorded, other] = (Fovea.runs = readRuns());
    document.getElementById("title").textContent = other.title;
    document.getElementById("subtitle").textContent =
      `A, solid: as recorded in ${recorded.title}. B, dashed: with ${other.settings.join(", ")}.`;
    Fovea.clock.duration = Math.max(0.001, recorded.t_s[recorded.t_s.length - 1] || 0);
    Fovea.clock.span = [0, Fovea.clock.duration];
    body("motion").append(el("div", { class: "toolbar" }, Fovea.zoomBar()), Fovea.bands.legend(Fovea.runs) || "");
    plot(
      body("motion"),
      "commanded speed of the camera [m/s]",
      pair("speed", "--blue", (run) => run.speed),
    );
    plot(
      body("motion"),
      "commanded angular speed of the camera [rad/s]",
      pair("turn", "--purple", (run) => run.turn),
    );
    plot(body("joints"), "velocities [rad/s or m/s]", ofJoints("dq_cmd"), { endLabels: true });
    plot(body("joints"), "torques without gravity [N m or N]", ofJoints("tau"), { endLabels: true });
    body("modes").append(
      table(
        ["run", "from [s]", "mode"],
        [0, 2],
        Fovea.runs.flatMap((run) =>
          run.modes.map((m) => [run.letter, m.t_s.toFixed(3), Fovea.words(m.mode.toLowerCase())]),
        ),
      ),
    );
    body("changes").append(
      table(
        ["field", "ticks that differ", "first at [s]", "largest difference", "at [s]"],
        [0],
        other.changes.map((c) => [
          c.field,
          String(c.ticks),
          c.first_s.toFixed(3),
          c.most === null ? "–" : Fovea.number(c.most, 3),
          c.most_s.toFixed(3),
        ]),
      ),
    );
    ["motion", "joints", "modes", "changes"].forEach(Fovea.drawn);
  }

  draw();
})();
