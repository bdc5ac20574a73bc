// SPDX-License-Identifier: Apache-2.0
// Reads a run's log.mcap with independent readers and compares it with the run's summary.json: the ticks by the hash
// that the run itself computed, the rest by counts and by expected values.
//   node read_log.mjs FOLDER [hardware]
// A hardware run has no ground truth, and no more pictures than configured.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import fs from "node:fs";
import path from "node:path";

import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers, protobufFromBinaryDescriptor } from "@mcap/support";

import { checkLayouts } from "./layouts.mjs";
import { compareWithOfficial } from "./schemas.mjs";

const folder = process.argv[2];
const simulated = process.argv[3] !== "hardware";
const file = path.join(folder, "log.mcap");
const summary = JSON.parse(fs.readFileSync(path.join(folder, "summary.json"), "utf8"));
const bytes = fs.readFileSync(file);
const decompressHandlers = await loadDecompressHandlers();

// Sequentially, with all checksums.
let streamed = 0;
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(bytes);
for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
  streamed += record.type === "Message" ? 1 : 0;
}
assert.ok(stream.done(), "the file is complete");

// By the index.
const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  },
  decompressHandlers,
});
const types = new Map();
for (const [id, schema] of reader.schemasById) {
  assert.equal(schema.encoding, "protobuf");
  types.set(id, protobufFromBinaryDescriptor(schema.data).lookupType(schema.name));
}
console.log(`${compareWithOfficial(types)} message types match Foxglove's definitions, field by field`);

const byTopic = new Map();
let last = 0n;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  assert.ok(message.logTime >= last, "the index gives messages in time order");
  last = message.logTime;
  const channel = reader.channelsById.get(message.channelId);
  const entries = byTopic.get(channel.topic) ?? [];
  entries.push({ time: message.logTime, data: types.get(channel.schemaId).decode(message.data) });
  byTopic.set(channel.topic, entries);
}
const of = (topic) => byTopic.get(topic) ?? [];
for (const [topic, entries] of byTopic) {
  console.log(`${topic}: ${entries.length}`);
}
assert.equal(streamed, Number(reader.statistics.messageCount));
assert.equal(
  streamed,
  [...byTopic.values()].reduce((sum, entries) => sum + entries.length, 0),
);

// Every tick, value by value: the same bytes as the run hashed.
const kMostJoints = 8;
const kMostFeature = 8;
class Bytes {
  parts = [];
  number(size, write) {
    const buffer = Buffer.alloc(size);
    write(buffer);
    this.parts.push(buffer);
  }
  u8(value) {
    this.number(1, (b) => b.writeUInt8(Number(value)));
  }
  i32(value) {
    this.number(4, (b) => b.writeInt32LE(value));
  }
  u32(value) {
    this.number(4, (b) => b.writeUInt32LE(value));
  }
  i64(value) {
    this.number(8, (b) => b.writeBigInt64LE(BigInt(value.toString())));
  }
  u64(value) {
    this.number(8, (b) => b.writeBigUInt64LE(BigInt(value.toString())));
  }
  f64(value) {
    this.number(8, (b) => b.writeDoubleLE(value));
  }
  f64s(values, count) {
    for (let i = 0; i < count; ++i) {
      this.f64(i < values.length ? values[i] : 0);
    }
  }
}
const hash = createHash("sha256");
const features = new Map(of("/servo/feature").map((entry) => [entry.time, entry.data]));
let feature = {
  stamp_ns: 0,
  sequence: 0,
  same_for_ns: 0,
  kind: 0,
  found: false,
  confidence: 0,
  s: [],
  cov_s: [],
  poses: [],
};
let taken = 0;
for (const { time, data: t } of of("/servo/tick")) {
  assert.equal(BigInt(t.stamp_ns.toString()), time);
  if (t.has_feature) {
    feature = features.get(time);
    assert.ok(feature, `the log has the measurement of tick ${t.tick}`);
    ++taken;
  }
  const out = new Bytes();
  out.u64(t.tick);
  out.i64(t.stamp_ns);
  out.i32(t.missed_ticks);
  out.i64(t.arm.stamp_ns);
  out.u64(t.arm.sequence);
  out.i32(t.arm.q.length);
  for (const values of [t.arm.q, t.arm.dq, t.arm.tau_meas, t.arm.tau_applied]) out.f64s(values, kMostJoints);
  out.u8(t.has_feature ? 1 : 0);
  out.i64(feature.stamp_ns);
  out.u64(feature.sequence);
  out.i64(feature.same_for_ns);
  out.u8(feature.kind);
  out.u8(feature.found ? 1 : 0);
  out.f64(feature.confidence);
  const dim = feature.s.length;
  out.i32(dim);
  out.f64s(feature.s, kMostFeature);
  for (let row = 0; row < kMostFeature; ++row) {
    out.f64s(row < dim ? feature.cov_s.slice(row * dim, (row + 1) * dim) : [], kMostFeature);
  }
  out.i32(feature.poses.length);
  for (const pose of feature.poses) {
    out.f64s(pose.p_CO_C, 3);
    out.f64s(pose.q_CO, 4);
    out.i32(pose.first);
  }
  if (t.tuning) {
    out.u8(t.tuning.result);
    out.i32(t.tuning.number);
    out.f64(t.tuning.before);
    out.f64(t.tuning.asked);
  }
  out.u8(t.intake);
  out.u8(t.mode);
  out.u8(t.hold_reason);
  out.u8(t.fault);
  out.i32(t.fault_joint);
  out.u32(t.limits_active);
  out.u8(t.target_known ? 1 : 0);
  out.i64(t.feature_age_ns);
  out.f64s(t.p_BO, 3);
  out.f64s(t.q_BO, 4);
  out.f64s(t.v_BO, 3);
  out.f64(t.stamp_late_s);
  out.f64(t.stamp_late_sigma_s);
  out.i32(t.s.length);
  for (const values of [t.s, t.s_star, t.e]) out.f64s(values, kMostFeature);
  out.f64s(t.V_BC_C_cmd, 6);
  out.u8(t.way.kind);
  out.u8(t.way.event);
  for (const number of [t.way.plans_asked, t.way.tries, t.way.outcome]) out.i32(number);
  out.f64s(t.way.normal_B, 3);
  for (const values of [t.q_cmd, t.dq_cmd, t.ddq_cmd, t.tau_ext]) out.f64s(values, kMostJoints);
  out.u64(t.command.state_sequence);
  out.i32(t.command.tau.length);
  out.f64s(t.command.tau, kMostJoints);
  out.u8(t.command.engage_brakes ? 1 : 0);
  hash.update(Buffer.concat(out.parts));
}
assert.equal(summary.log_entries_dropped, 0);
if (simulated) assert.equal(summary.log_pictures_dropped, 0);
assert.equal(of("/servo/tick").length, summary.ticks);
assert.equal(taken, features.size);
assert.equal(hash.digest("hex"), summary.log_hash, "all values of all ticks");
console.log(`${summary.ticks} ticks match the run's hash ${summary.log_hash}`);

// The rest, by expected values.
const pictures = simulated ? summary.frames : summary.log_pictures;
assert.equal(of("/camera/image").length, pictures);
assert.equal(of("/camera/annotations").length, pictures + summary.log_pictures_dropped);
for (const { data } of of("/camera/image")) {
  assert.equal(data.format, "jpeg");
  assert.deepEqual([...data.data.slice(0, 2), ...data.data.slice(-2)], [0xff, 0xd8, 0xff, 0xd9]);
}
const calibration = of("/camera/calibration")[0].data;
assert.equal(calibration.K.length, 9);
if (simulated) {
  assert.equal(of("/truth").length, summary.ticks + 1, "one for each tick, and one for the start");
  const errors = of("/truth").map(({ data }) => data);
  const windowStart = errors.at(-1).stamp_ns - 5e8;
  const window = errors.filter((e) => e.stamp_ns > windowStart);
  const rms = Math.sqrt(window.reduce((sum, e) => sum + e.error_px * e.error_px, 0) / window.length);
  if (summary.final_error_px_rms !== null) {
    assert.ok(
      Math.abs(rms - summary.final_error_px_rms) < 1e-9,
      `${rms} px, the summary says ${summary.final_error_px_rms}`,
    );
  }
} else {
  assert.ok(pictures > 0);
  assert.equal(of("/truth").length, 0, "hardware has no ground truth");
}
const frames = new Set(of("/tf").flatMap(({ data }) => data.transforms.map((t) => t.child_frame_id)));
for (const { data } of of("/scene")) {
  for (const entity of data.entities) {
    assert.ok(
      frames.has(entity.frame_id) || entity.frame_id === "fovea/base",
      `${entity.id} has a frame with transforms`,
    );
  }
}
for (const { data } of of("/tf")) {
  for (const { rotation: q } of data.transforms) {
    assert.ok(Math.abs(Math.hypot(q.x, q.y, q.z, q.w) - 1) < 1e-12);
  }
}
const words = of("/servo/events").map(({ data }) => data.message);
const ofModes = words.filter((text) => /^(mode|fault): /.test(text));
assert.equal(ofModes.length, summary.modes.length, words.join("; "));
const ofPlans = of("/servo/tick").filter(({ data }) => data.way.event).length;
assert.equal(words.length, ofModes.length + ofPlans, words.join("; "));
assert.equal(of("/setup").length, 1);
const counted = of("/servo/tick_times")[0].data.counts.reduce((sum, count) => sum + Number(count), 0);
assert.equal(counted, summary.ticks);

const layouts = new URL("../../tools/layouts", import.meta.url).pathname;
if (simulated) console.log(`${checkLayouts(layouts, byTopic)} streams and fields of the layouts are in the log`);

const metadata = {};
for await (const record of reader.readMetadata()) {
  metadata[record.name] = record.metadata;
}
assert.equal(metadata.build.get("git"), summary.git);
assert.equal(metadata.build.get("servo library"), summary.servo);
assert.match(metadata.build.get("flags"), /-ffp-contract=off/);
assert.match(metadata.robot.get("model"), /^[0-9a-f]{64}$/);
assert.ok(metadata.configuration.has("servo.lambda"));
const attachments = {};
for await (const attachment of reader.readAttachments({ validateCrcs: true })) {
  attachments[attachment.name] = Buffer.from(attachment.data);
}
assert.deepEqual(JSON.parse(attachments["summary.json"].toString()), summary);
assert.deepEqual(attachments["camera.mp4"], fs.readFileSync(path.join(folder, "camera.mp4")));
console.log("log.mcap matches the run");
