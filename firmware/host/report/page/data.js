// SPDX-License-Identifier: Apache-2.0
// Reads the embedded runs.

// base64 of little-endian float32 to a typed array; null stays null.
Fovea.floats = function (text) {
  if (typeof text !== "string") return null;
  const bytes = Fovea.bytes(text);
  return new Float32Array(bytes.buffer, 0, Math.floor(bytes.length / 4));
};

Fovea.bytes = function (text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
};

Fovea.readRuns = function () {
  const letters = "ABCDEFGH";
  return Array.from(document.querySelectorAll("script.fovea-run")).map((node, index) => {
    const run = JSON.parse(node.textContent);
    run.letter = letters[index];
    run.index = index;
    Fovea.decode(run);
    return run;
  });
};

// Turns the encoded arrays into typed arrays, and absent parts into empty ones.
Fovea.decode = function (run) {
  const list = (value) => (Array.isArray(value) ? value : []);
  const ticks = run.ticks || {};
  run.ticks = {};
  for (const key of ["t_s", "error_px", "error_mm", "predicted_px", "path_error_mm"])
    run.ticks[key] = Fovea.floats(ticks[key]);
  for (const key of ["q", "dq", "tau", "tau_meas", "tau_ext", "twist_cmd", "twist_meas", "e"])
    run.ticks[key] = list(ticks[key]).map(Fovea.floats);
  const measured = run.measured || {};
  run.measured = {};
  for (const key of ["t_s", "error_px", "age_ms", "confidence"]) run.measured[key] = Fovea.floats(measured[key]);
  if (run.theory) for (const key of ["t_s", "x", "goal", "analytic"]) run.theory[key] = Fovea.floats(run.theory[key]);
  if (run.feature_path)
    for (const key of ["goal_px", "t_s", "px"]) run.feature_path[key] = Fovea.floats(run.feature_path[key]);
  for (const key of ["modes", "faults", "limits_active", "joints", "error_components", "lost", "not_found"])
    run[key] = list(run[key]);
  run.operator = [
    ...list(run.tunings).map((t) => ({ kind: t.taken ? "tuned" : "mark", t_s: t.t_s, words: t.words })),
    ...list(run.touches).map((t) => ({ kind: "tuned", t_s: t.t_s, words: t.words })),
  ].sort((a, b) => a.t_s - b.t_s);
  run.info = run.info || {};
  run.has_eye = !!run.target;
  run.target = run.target || {};
  if (!Number.isFinite(run.duration_s)) {
    const last = (times) => (times && times.length ? times[times.length - 1] : 0);
    run.duration_s = Math.max(last(run.ticks.t_s), last(run.measured.t_s)) || 0;
  }
  if (run.scene) {
    for (const key of ["t_s", "poses", "camera_path", "target_path", "target_turn"])
      run.scene[key] = Fovea.floats(run.scene[key]);
    for (const link of list(run.scene.links))
      for (const shape of list(link.shapes)) shape.vertices = Fovea.floats(shape.vertices);
  }
};

// The value of a series at time t: that of the row nearest to it, NaN when none is within `reach` seconds.
Fovea.valueAt = function (times, values, t, reach) {
  let index = Fovea.indexAt(times, t);
  if (index + 1 < times.length && (index < 0 || times[index + 1] - t < t - times[index])) index++;
  return index >= 0 && Math.abs(times[index] - t) <= reach ? values[index] : NaN;
};

// The number of frames in `spans`.
Fovea.frameCount = (spans) => spans.reduce((sum, span) => sum + span.frames, 0);

// The name of the target; null for a run without a camera.
Fovea.targetWord = (run) =>
  run.has_eye ? { sphere: "ball", circle: "disc" }[run.target.kind] || Fovea.words(run.target.kind) : null;

// The value of a key of the configuration, as text; null when it is not there.
Fovea.setting = function (run, key) {
  const [section, name] = key.split(".");
  let here = false;
  for (const line of String(run.config || "").split("\n")) {
    if (line.startsWith("[")) here = line === `[${section}]`;
    else if (here && line.startsWith(`${name} = `)) return line.slice(name.length + 3);
  }
  return null;
};

Fovea.hasNumbers = (values) => !!values && values.some(Number.isFinite);

Fovea.drawn = (id) => {
  document.getElementById(id).dataset.drawn = "true";
};
