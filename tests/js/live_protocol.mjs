// SPDX-License-Identifier: Apache-2.0
// Talks to the live page's server with Foxglove's own client: channels, schemas, parameters, services, publishing, under
// both subprotocol names.
//   node live_protocol.mjs PROGRAM       PROGRAM: tests/host/live/live_example.cpp
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { createInterface } from "node:readline";

import { protobufFromBinaryDescriptor } from "@mcap/support";
import wsProtocol from "@foxglove/ws-protocol";
import WebSocket from "ws";

import { compareWithOfficial } from "./schemas.mjs";

const { FoxgloveClient } = wsProtocol;
const kLimitMs = 30_000;

const program = spawn(process.argv[2], { stdio: ["pipe", "pipe", "inherit"] });
const [url] = await once(createInterface({ input: program.stdout }), "line");
const address = url.replace(/^http/, "ws");

// The first event of that name that `wanted` accepts.
function next(client, name, wanted = () => true) {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`no ${name} came`)), kLimitMs);
    const listener = (event) => {
      if (wanted(event)) {
        clearTimeout(timer);
        client.off(name, listener);
        resolve(event);
      }
    };
    client.on(name, listener);
  });
}

const bytesOf = (view) => new Uint8Array(view.buffer, view.byteOffset, view.byteLength);
const jsonOf = (view) => JSON.parse(new TextDecoder().decode(bytesOf(view)));
const jsonBytes = (value) => new TextEncoder().encode(JSON.stringify(value));

async function talk(subprotocol) {
  const socket = new WebSocket(address, [subprotocol]);
  const client = new FoxgloveClient({ ws: socket });
  client.on("error", (error) => {
    throw error;
  });
  const [info, channels, services] = await Promise.all([
    next(client, "serverInfo"),
    next(client, "advertise"),
    next(client, "advertiseServices"),
  ]);
  assert.equal(socket.protocol, subprotocol);
  assert.equal(info.name, "fovea: example");
  assert.deepEqual(info.capabilities, ["time", "parameters", "parametersSubscribe", "services", "clientPublish"]);

  // Every protobuf schema can be read by itself, and Foxglove's types are Foxglove's.
  const types = new Map();
  for (const channel of channels.filter((each) => each.encoding === "protobuf")) {
    assert.equal(channel.schemaEncoding, "protobuf");
    const root = protobufFromBinaryDescriptor(Buffer.from(channel.schema, "base64"));
    types.set(channel.id, root.lookupType(channel.schemaName));
  }
  const compared = compareWithOfficial(types);
  const idOf = (topic) => {
    const channel = channels.find((each) => each.topic === topic);
    assert.ok(channel, topic);
    return channel.id;
  };
  const subscribe = async (topic, wanted = () => true) => {
    const id = client.subscribe(idOf(topic));
    const message = await next(client, "message", (event) => event.subscriptionId === id && wanted(event));
    client.unsubscribe(id);
    return message;
  };

  const setup = types.get(idOf("/setup")).decode(bytesOf((await subscribe("/setup")).data));
  assert.equal(setup.name, "example");
  assert.equal(setup.lambda, 2);
  const tick = await subscribe("/servo/tick");
  const decoded = types.get(idOf("/servo/tick")).decode(bytesOf(tick.data));
  assert.equal(BigInt(decoded.stampNs?.toString() ?? decoded.stamp_ns.toString()), tick.timestamp);
  assert.deepEqual([...decoded.e], [0.5]);
  assert.ok((await next(client, "time")).timestamp > 0n);
  const first = jsonOf((await subscribe("/live/state")).data);
  assert.equal(first.faults[0].name, "load");
  assert.equal(first.may.pause, false);
  assert.equal(jsonOf((await subscribe("/live/parameters")).data)[0].max, 10);

  const call = async (name, request) => {
    const service = services.find((each) => each.name === name);
    assert.ok(service, name);
    assert.equal(JSON.parse(service.request.schema).type, "object");
    const callId = ++call.last;
    const mine = (event) => event.callId === callId;
    const answered = Promise.any([
      next(client, "serviceCallResponse", mine).then((event) => ({ value: jsonOf(event.data) })),
      next(client, "serviceCallFailure", mine).then((event) => ({ error: event.message })),
    ]);
    client.sendServiceCallRequest({ serviceId: service.id, callId, encoding: "json", data: jsonBytes(request) });
    return answered;
  };
  call.last = 0;
  assert.deepEqual(await call("/control/take", { name: "Ada" }), { value: { granted: true, controller: "Ada" } });
  assert.deepEqual(await call("/servo/hold", {}), { value: {} });
  assert.deepEqual(await call("/servo/track", {}), { error: "the target was not seen yet" });
  assert.deepEqual(await call("/run/save", {}), { value: { name: "example-at-1.000s.toml", toml: "[run]" } });
  assert.deepEqual(await call("/fault/start", { name: "load", settings: { load_mass: 4 } }), {
    error: "load_mass must be a number from 0.0 to 3.0, got 4",
  });
  assert.deepEqual(await call("/fault/start", { name: "load", settings: { load_mass: 2.5 } }), { value: {} });
  const after = jsonOf((await subscribe("/live/state", (event) => jsonOf(event.data).faults[0].active)).data);
  assert.equal(after.faults[0].settings[0].value, 2.5);
  assert.equal(after.mode, "hold");
  assert.equal(after.controller, "Ada");
  assert.equal(after.you, true);

  client.getParameters([], "all");
  const all = await next(client, "parameterValues", (event) => event.id === "all");
  assert.equal(all.parameters[0].name, "servo.lambda");
  assert.equal(all.parameters[0].type, "float64");
  client.subscribeParameterUpdates(["servo.lambda"]);
  client.setParameters([{ name: "servo.lambda", value: 3.5 }], "set");
  const set = await next(client, "parameterValues", (event) => event.id === "set");
  assert.deepEqual(set.parameters, [{ name: "servo.lambda", value: 3.5, type: "float64" }]);
  client.setParameters([{ name: "servo.lambda", value: 100 }], "refused");
  const status = await next(client, "status");
  assert.equal(status.level, 2);
  assert.equal(status.message, "servo.lambda must be a number from 0.1 to 10 1/s, got 100");

  const pose = client.advertise({ topic: "/target/pose", encoding: "json", schemaName: "fovea.live.Pose" });
  client.sendMessage(pose, jsonBytes({ p_BO: [0.5, 0, 0.1], q_BO: [1, 0, 0, 0] }));
  const held = jsonOf((await subscribe("/live/state", (event) => jsonOf(event.data).target)).data);
  assert.deepEqual(held.target, { p_BO: [0.5, 0, 0.1], q_BO: [1, 0, 0, 0], held: true });
  const closed = once(socket, "close");
  client.close();
  await closed;
  console.log(
    `${subprotocol}: ${channels.length} channels, ${compared} types as Foxglove's, ${services.length} services`,
  );
}

try {
  await talk("foxglove.websocket.v1");
  await talk("foxglove.sdk.v1");
  const refused = new WebSocket(address.replace(/token=.*/, "token=wrong"), ["foxglove.sdk.v1"]);
  const [, response] = await once(refused, "unexpected-response");
  assert.equal(response.statusCode, 401);
  refused.on("error", () => {});
  refused.terminate();
} finally {
  program.stdin.end();
}
const [code] = await once(program, "exit");
assert.equal(code, 0);
