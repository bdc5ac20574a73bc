// SPDX-License-Identifier: Apache-2.0
// The modes of the servo: words and colour of each.

Fovea.MODES = {
  boot: { words: "getting ready", colour: "--mode-boot" },
  hold: { words: "standing still and waiting", colour: "--mode-hold" },
  track: { words: "steering to the target", colour: "--mode-track" },
  coast: { words: "steering only by prediction", colour: "--mode-coast" },
  move: { words: "following a commanded motion", colour: "--mode-move" },
  fault: { words: "stopped by a fault", colour: "--bad" },
};

Fovea.modeWords = (mode) => (Fovea.MODES[mode] ? Fovea.MODES[mode].words : Fovea.words(mode));
