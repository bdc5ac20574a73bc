// SPDX-License-Identifier: Apache-2.0
// What the page knows of the run: its setup, its state, and the last minute of what was received.
// Times are run time: seconds since the run's start.
import { Pictures, Rows } from "./history.js";

const MOST_JOINTS = 8;
const LEAST_S = 0.008; // between two rows of a plot
const ROWS = 7600; // a minute of them
const IDEAL_JUMP = 1.3; // an error that grows so much restarts the ideal line

// Columns of `ticks`.
export const TICK = { mode: 0, limits: 1, age_ms: 2, v: 3, omega: 6, q: 9, tau: 9 + MOST_JOINTS };
// Columns of `truth`.
export const TRUTH = { error_px: 0, p_BO: 1, q_BO: 4 };
// Columns of `errors` (true ones) and `measured` (in the picture): in pixels.
export const ERROR = { size: 0, ideal: 1 };
export const CAMERA_FRAME = "fovea/camera";
export const TARGET_FRAME = "fovea/target";
const BASE_FRAME = "fovea/base";
export const MODES = ["BOOT", "HOLD", "TRACK", "COAST", "FAULT", "MOVE"];

const nanoseconds = (stamp) => stamp.seconds * 1e9 + stamp.nanos; // exact: equal stamps are equal numbers

export class Model {
  #listeners = Fovea.callbacks();
  #last = { tick: -Infinity, truth: -Infinity };
  #ideal = null; // {t, px, lambda}: where the ideal line begins

  constructor() {
    this.setup = null;
    this.state = null;
    this.parameters = [];
    this.links = null; // of the scene: [{frame, shapes}]; the camera's housing is one of them
    this.hand = null; // frame of the robot's last link
    this.tableZ = 0;
    this.frames = [];
    this.lambda = NaN;
    this.now = 0; // time of the newest message
    this.error = NaN; // the newest error [px]
    this.pictures = new Pictures({ least_s: 0.09, most_bytes: 64e6 });
    this.ticks = new Rows(TICK.tau + MOST_JOINTS, ROWS);
    this.truth = new Rows(8, ROWS);
    this.errors = new Rows(2, ROWS);
    this.measured = new Rows(2, ROWS);
    this.tickTimes = new Rows(2, 800);
    this.poses = null;
    this.events = [];
  }

  // Kinds: setup, scene, state, picture, motion, event, parameters, reset.
  listen(callback) {
    return this.#listeners.listen(callback);
  }

  follow(connection) {
    const on = (topic, take) => connection.subscribe(topic, (message, time) => take(message, time));
    on("/setup", (message) => this.#takeSetup(message));
    on("/scene", (message) => this.#takeScene(message));
    on("/tf", (message) => this.#takePoses(message));
    on("/servo/tick", (message) => this.#takeTick(message));
    on("/servo/events", (message, time) => this.#takeEvent(message, time));
    on("/truth", (message) => this.#takeTruth(message));
    on("/camera/image", (message) => {
      const t = this.#timeOf(nanoseconds(message.timestamp));
      if (t === null) return;
      this.#listeners.tell("picture", this.pictures.addPicture(t, message.data.slice()));
    });
    on("/camera/annotations", (message, time) => this.#takeOutlines(message, time));
    on("/live/state", (message) => this.#takeState(message));
    on("/live/parameters", (list) => {
      this.parameters = list;
      this.#listeners.tell("parameters");
    });
  }

  get oldest() {
    const rows = [this.ticks, this.truth, this.poses].find((one) => one?.size);
    return rows ? rows.t[rows.begin] : this.now;
  }

  // False for the page of a served robot: its servo runs in another program.
  get hasServo() {
    return this.state?.mode !== "";
  }

  // Null before the setup is known.
  #timeOf(stamp_ns) {
    if (!this.setup) return null;
    const t = (stamp_ns - this.setup.start_ns) * 1e-9;
    if (t > this.now) this.now = t;
    return t;
  }

  #forget() {
    for (const rows of [this.ticks, this.truth, this.errors, this.measured, this.tickTimes, this.poses]) rows?.clear();
    this.pictures.clear();
    this.events = [];
    this.#last = { tick: -Infinity, truth: -Infinity };
    this.#ideal = null;
    this.now = 0;
    this.#listeners.tell("reset");
  }

  #takeSetup(message) {
    if (this.setup && this.setup.start_ns !== message.start_ns) this.#forget();
    const known = JSON.stringify(this.setup) === JSON.stringify(message); // sent again to a new connection
    this.setup = message;
    if (known) return;
    if (!Number.isFinite(this.lambda)) this.lambda = message.lambda;
    this.#listeners.tell("setup");
  }

  #takeScene({ entities }) {
    if (this.links) return; // sent again to a new connection
    const table = entities.find(({ id }) => id === "table")?.cubes[0];
    if (table) this.tableZ = table.pose.position.z + table.size.z / 2;
    const shape = (kind, size) => (primitive) => {
      const { position: p, orientation: q } = primitive.pose;
      const { r, g, b } = primitive.color || { r: 0.8, g: 0.8, b: 0.8 };
      return {
        kind,
        position: [p.x, p.y, p.z],
        quaternion: [q.w, q.x, q.y, q.z],
        colour: [r, g, b],
        ...size(primitive),
      };
    };
    this.links = entities
      .filter(({ frame_id }) => frame_id !== BASE_FRAME && frame_id !== TARGET_FRAME)
      .map(({ frame_id, cubes, cylinders, spheres, triangles }) => ({
        frame: frame_id,
        shapes: [
          ...cubes.map(shape("box", ({ size }) => ({ size: [size.x, size.y, size.z] }))),
          ...cylinders.map(shape("cylinder", ({ size }) => ({ size: [size.x / 2, size.z] }))),
          ...spheres.map(shape("sphere", ({ size }) => ({ size: [size.x / 2] }))),
          ...triangles.map(shape("mesh", ({ points, indices }) => ({ vertices: loose(points, indices) }))),
        ],
      }));
    this.hand = this.links.findLast(({ frame }) => frame !== CAMERA_FRAME)?.frame;
    this.frames = [...new Set([...this.links.map((link) => link.frame), CAMERA_FRAME, TARGET_FRAME])];
    this.poses = new Rows(7 * this.frames.length, 3200);
    this.#listeners.tell("scene");
  }

  #takePoses({ transforms }) {
    if (!this.poses || !transforms.length) return;
    const t = this.#timeOf(nanoseconds(transforms[0].timestamp));
    if (t === null || t - this.#lastPose() < LEAST_S) return;
    const row = new Array(this.poses.width).fill(NaN);
    for (const { child_frame_id, translation: p, rotation: q } of transforms) {
      const at = 7 * this.frames.indexOf(child_frame_id);
      if (at >= 0) [p.x, p.y, p.z, q.w, q.x, q.y, q.z].forEach((value, i) => (row[at + i] = value));
    }
    this.poses.add(t, row);
    this.#listeners.tell("motion");
  }

  #lastPose() {
    return this.poses.size ? this.poses.t[this.poses.end - 1] : -Infinity;
  }

  // Position and orientation of a frame at time t: [x, y, z, qw, qx, qy, qz], or null.
  poseOf(frame, t) {
    const row = this.poses?.rowAt(t);
    const at = 7 * this.frames.indexOf(frame);
    return row && at >= 0 && Number.isFinite(row[at]) ? row.subarray(at, at + 7) : null;
  }

  #takeTick(tick) {
    const t = this.#timeOf(tick.stamp_ns);
    if (t === null) return;
    if (t < this.#last.tick - 0.05) this.#forget();
    this.tick = tick;
    if (t - this.#last.tick < LEAST_S) return;
    this.#last.tick = t;
    const mode = MODES.indexOf(tick.mode);
    const row = new Array(this.ticks.width).fill(NaN);
    row[TICK.mode] = mode;
    row[TICK.limits] = tick.limits_active;
    row[TICK.age_ms] = tick.target_known ? tick.feature_age_ns / 1e6 : NaN;
    tick.V_BC_C_cmd.forEach((value, i) => (row[TICK.v + i] = value));
    this.setup.joints.forEach((joint, i) => {
      const share = (value, low, high) => (high > low ? (200 * (value - low)) / (high - low) - 100 : NaN);
      row[TICK.q + i] = share(tick.arm?.q[i], joint.q_min, joint.q_max);
      row[TICK.tau + i] = share(tick.command?.tau[i], -joint.tau_max, joint.tau_max);
    });
    this.ticks.add(t, row);
  }

  #takeTruth(truth) {
    const t = this.#timeOf(truth.stamp_ns);
    if (t === null || t - this.#last.truth < LEAST_S) return;
    this.#last.truth = t;
    this.truth.add(t, [truth.error_px, ...truth.p_BO, ...truth.q_BO]);
    this.#addError(this.errors, t, truth.error_px, true);
  }

  #takeOutlines(message, time) {
    const t = this.#timeOf(message.timestamp ? nanoseconds(message.timestamp) : time);
    if (t === null) return;
    const outlines = message.points.map(({ points, metadata }) => ({
      role: metadata.find(({ key }) => key === "role")?.value || "",
      points,
    }));
    this.pictures.addOutlines(t, outlines);
    const middle = (role) => {
      const points = outlines.find((one) => one.role === role)?.points;
      if (!points?.length) return null;
      return ["x", "y"].map((axis) => points.reduce((sum, p) => sum + p[axis], 0) / points.length);
    };
    const [goal, seen] = [middle("goal"), middle("detection")];
    if (goal && seen)
      this.#addError(this.measured, t, Math.hypot(goal[0] - seen[0], goal[1] - seen[1]), !this.truth.size);
    this.#listeners.tell("outlines", t);
  }

  // The ideal line begins where the servo begins to track, and again where something threw the error up. `leads`: it
  // belongs to these errors.
  #addError(rows, t, px, leads) {
    const last = rows.size ? rows.t[rows.end - 1] : -Infinity;
    if (t <= last) return;
    let ideal = NaN;
    if (leads) {
      if (this.tick?.mode !== "TRACK") this.#ideal = null;
      else if (px > 0) {
        ideal = this.#ideal ? this.#ideal.px * Math.exp(-this.#ideal.lambda * (t - this.#ideal.t)) : NaN;
        const thrown = px > IDEAL_JUMP * this.error && px > 2 * ideal + 2;
        if (!this.#ideal || thrown || this.#ideal.lambda !== this.lambda) {
          this.#ideal = { t, px, lambda: this.lambda };
          ideal = px;
        }
      }
      this.error = px;
    }
    rows.add(t, [px, ideal]);
  }

  #takeEvent({ level, message }, time) {
    const t = this.#timeOf(time);
    if (t === null) return;
    this.events.push({ t, level, message });
    if (this.events.length > 60) this.events.shift();
    this.#listeners.tell("event");
  }

  #takeState(state) {
    if (this.state && state.stamp_s < this.state.stamp_s - 0.05) this.#forget();
    this.state = state;
    if (state.stamp_s > this.now) this.now = state.stamp_s;
    if (state.tick_us) this.tickTimes.add(state.stamp_s, [state.tick_us.median, state.tick_us.max]);
    this.#listeners.tell("state");
  }
}

// The corners of all triangles, one after the other.
function loose(points, indices) {
  const order = indices.length ? indices : points.keys();
  return Float32Array.from([...order].flatMap((i) => [points[i].x, points[i].y, points[i].z]));
}
