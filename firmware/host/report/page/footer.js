// SPDX-License-Identifier: Apache-2.0
// The page's footer: scenario, target and version of each run, and the command that repeats it.

Fovea.footer = (function () {
  const { el } = Fovea;

  const version = (run) => run.info.version || (run.summary && run.summary.version) || null;

  function sentence(run) {
    const target = Fovea.targetWord(run);
    const moves = run.target.moves ? "moving " : "";
    const parts = [
      `${Fovea.runs.length > 1 ? `Run ${run.letter}` : "This run"}: ${run.summary && run.summary.scenario ? "scenario " : ""}${run.name}`,
      target ? `target: a ${moves}${target}` : "no camera and no target",
      version(run) ? `Fovea ${version(run)}${run.info.git ? ` (${run.info.git})` : ""}` : "the log names no version",
    ];
    return parts.join("; ") + ".";
  }

  function aim(runs) {
    const targets = Array.from(new Set(runs.map(Fovea.targetWord).filter(Boolean)));
    if (!targets.length) return "There is no camera in this run: the servo steers the arm along a commanded motion.";
    const name = targets.length === 1 ? targets[0] : "target";
    return `The camera sits in the robot's hand. The servo steers the arm so that the ${name} reaches its goal in the camera's image. The image error is the distance of the ${name} from that goal in the picture, in pixels.`;
  }

  function repeat(run) {
    if (!run.command)
      return Fovea.absent(
        `The log${Fovea.runs.length > 1 ? ` of run ${run.letter}` : ""} does not name the command that started the run.`,
      );
    return el(
      "div",
      { class: "repeat" },
      el("code", { text: run.command }),
      Fovea.copyButton(
        run.command,
        `Copy the command that repeats ${Fovea.runs.length > 1 ? `run ${run.letter}` : "the run"}`,
      ),
    );
  }

  function draw(runs) {
    document.getElementById("aim").textContent = aim(runs);
    document.getElementById("about").append(...runs.flatMap((run) => [el("p", { text: sentence(run) }), repeat(run)]));
    Fovea.drawn("about");
  }

  return { draw };
})();
