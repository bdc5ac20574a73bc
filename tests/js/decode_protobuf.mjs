// SPDX-License-Identifier: Apache-2.0
// Compares the live page's reader of protobuf with protobufjs: on every message of a log, on each type of field, and on
// messages that are cut.
//   node decode_protobuf.mjs FOLDER
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";

import { protobufFromBinaryDescriptor } from "@mcap/support";
import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";

import { readLog } from "./read_mcap.mjs";

// A browser knows that it is a module; Node 18 does not know it from the name.
const reader = fs.readFileSync(new URL("../../firmware/host/live/page/protobuf.js", import.meta.url), "base64");
const { decoder } = await import(`data:text/javascript;base64,${reader}`);

const { channels, messages } = await readLog(path.join(process.argv[2], "log.mcap"));

// As our reader gives a message: numbers for 64-bit integers, names of enumerations, null for what is absent.
function plain(type, message) {
  const result = {};
  for (const field of type.fieldsArray) {
    field.resolve();
    const one = (value) => {
      if (field.resolvedType instanceof protobuf.Type) return value === null ? null : plain(field.resolvedType, value);
      if (field.resolvedType instanceof protobuf.Enum) return field.resolvedType.valuesById[value];
      if (field.type === "bytes") return value.length ? Buffer.from(value).toString("hex") : "";
      return typeof value === "object" && value !== null ? Number(value.toString()) : value;
    };
    const value = message[field.name];
    result[field.name] = field.repeated ? (value ?? []).map(one) : one(value ?? field.typeDefault ?? null);
  }
  return result;
}
const shown = (value) =>
  JSON.parse(JSON.stringify(value, (key, v) => (v instanceof Uint8Array ? Buffer.from(v).toString("hex") : v)));
const sameBytes = (type, ours) => {
  for (const field of type.fieldsArray)
    if (field.type === "bytes" && !field.repeated && ours[field.name] === null) ours[field.name] = "";
  return ours;
};

const compared = new Map();
for (const { channelId, data } of messages) {
  const channel = channels.get(channelId);
  channel.read ??= decoder(channel.schema.data, channel.schema.name);
  channel.type ??= protobufFromBinaryDescriptor(channel.schema.data).lookupType(channel.schema.name);
  const count = compared.get(channel.topic) ?? 0;
  compared.set(channel.topic, count + 1);
  const ours = channel.read(data);
  if (count % 50 === 0)
    assert.deepEqual(sameBytes(channel.type, shown(ours)), shown(plain(channel.type, channel.type.decode(data))));
}
console.log(`${messages.length} messages of ${compared.size} streams`);
assert.ok(compared.size >= 10 && messages.length > 1000);

// Each type of field with its extreme values, alone and in packed and unpacked lists.
const kinds = {
  double: [0.1, -Infinity],
  float: [0.5, -3],
  int64: [-(2 ** 53), 2 ** 53],
  uint64: [2 ** 53, 7],
  int32: [-(2 ** 31), 2 ** 31 - 1],
  uint32: [2 ** 32 - 1, 128],
  sint32: [-(2 ** 31), 2 ** 31 - 1, -1],
  sint64: [-(2 ** 52) - 1, 2 ** 52, -1],
  fixed32: [2 ** 32 - 1, 1],
  fixed64: [2 ** 53, 1],
  sfixed32: [-(2 ** 31), 5],
  sfixed64: [-(2 ** 53), 5],
  bool: [true, false],
  string: ["Grüße", ""],
};
const lines = Object.keys(kinds).flatMap((kind, i) => [
  `${kind} one_${kind} = ${3 * i + 1};`,
  `repeated ${kind} packed_${kind} = ${3 * i + 2};`,
  `repeated ${kind} loose_${kind} = ${3 * i + 3}${kind === "string" ? "" : " [packed = false]"};`,
]);
const root = protobuf.parse(`syntax = "proto3"; package t; message All { ${lines.join("\n")} }`, {
  keepCase: true,
}).root;
root.resolveAll();
const All = root.lookupType("t.All");
const value = {};
for (const [kind, list] of Object.entries(kinds)) {
  const long = /64/.test(kind)
    ? (v) => protobuf.util.Long.fromNumber(v, kind.startsWith("u") || kind === "fixed64")
    : (v) => v;
  value[`one_${kind}`] = long(list[0]);
  value[`packed_${kind}`] = value[`loose_${kind}`] = list.map(long);
}
const bytes = All.encode(All.create(value)).finish();
const schema = descriptor.FileDescriptorSet.encode(root.toDescriptor("proto3")).finish();
const read = decoder(schema, "t.All");
const got = read(bytes);
for (const [kind, list] of Object.entries(kinds)) {
  assert.equal(got[`one_${kind}`], list[0], kind);
  assert.deepEqual(got[`packed_${kind}`], list, kind);
  assert.deepEqual(got[`loose_${kind}`], list, kind);
}

// A message that is cut within a field is refused with a RangeError; nothing else happens.
let refused = 0;
for (let size = 0; size < bytes.length; size++) {
  try {
    read(bytes.subarray(0, size));
  } catch (error) {
    assert.ok(error instanceof RangeError, String(error));
    refused++;
  }
}
assert.ok(refused > bytes.length / 2, `${refused} of ${bytes.length} cuts are refused`);
assert.throws(() => decoder(schema, "t.None"), /no message t.None/);
console.log(`${Object.keys(kinds).length} types of fields; ${refused} of ${bytes.length} cuts are refused`);
