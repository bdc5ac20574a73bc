// SPDX-License-Identifier: Apache-2.0
// The live page of the hardware program, with the simulated robot: what a viewer may do without control and with it.
//   node live_hw.mjs FOVEA-SIM FOVEA-HW FOLDER
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import fs from "node:fs";
import path from "node:path";
import { createInterface } from "node:readline";

import { protobufFromBinaryDescriptor } from "@mcap/support";
import wsProtocol from "@foxglove/ws-protocol";
import WebSocket from "ws";

import { readLog } from "./read_mcap.mjs";

const [sim, hw, folder] = process.argv.slice(2);
const { FoxgloveClient } = wsProtocol;
const LIMIT_MS = 60_000;
fs.rmSync(folder, { recursive: true, force: true });
fs.mkdirSync(folder, { recursive: true });
const running = new Set();

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// Starts a program, and waits for a line on its stderr that `pattern` matches. Returns the match and the program.
async function begin(file, args, pattern) {
  const program = spawn(file, args, { stdio: ["pipe", "ignore", "pipe"] });
  running.add(program);
  program.exited = once(program, "exit").then(([code]) => {
    running.delete(program);
    return code;
  });
  const said = [];
  createInterface({ input: program.stderr }).on("line", (line) => said.push(line));
  program.says = async (words) => {
    for (const end = Date.now() + LIMIT_MS; Date.now() < end; await pause(20)) {
      const match = said.map((line) => line.match(words)).find(Boolean);
      if (match) return match;
    }
    throw new Error(`${file} did not say ${words}: ${said}`);
  };
  return { match: await program.says(pattern), program };
}

// The decoded messages of some topics of a run's log, in order: [{topic, message}].
async function read(out, topics) {
  const { channels, messages } = await readLog(path.join(out, "log.mcap"));
  return messages.flatMap(({ channelId, data }) => {
    const { topic, schema } = channels.get(channelId);
    if (!topics.includes(topic)) return [];
    return [{ topic, message: protobufFromBinaryDescriptor(schema.data).lookupType(schema.name).decode(data) }];
  });
}

const touchesOf = (all) => all.filter(({ topic }) => topic === "/operator").map(({ message }) => message.what);

const bytesOf = (view) => new Uint8Array(view.buffer, view.byteOffset, view.byteLength);

// A viewer of the page at `url`.
async function view(url) {
  const socket = new WebSocket(url.replace(/^http/, "ws"), ["foxglove.sdk.v1"]);
  const client = new FoxgloveClient({ ws: socket });
  const events = { serverInfo: [], advertise: [], advertiseServices: [], parameterValues: [], status: [] };
  for (const name of Object.keys(events)) client.on(name, (event) => events[name].push(event));
  const until = async (what, found) => {
    for (const end = Date.now() + LIMIT_MS; Date.now() < end; ) {
      const value = found();
      if (value !== undefined) return value;
      await pause(20);
    }
    throw new Error(`no ${what} came`);
  };
  const services = await until("services", () => events.advertiseServices[0]);
  let calls = 0;
  const call = (name, request) =>
    new Promise((resolve, reject) => {
      const service = services.find((each) => each.name === name);
      assert.ok(service, name);
      const callId = ++calls;
      setTimeout(() => reject(new Error(`no answer to ${name}`)), LIMIT_MS).unref();
      client.on("serviceCallResponse", (event) => event.callId === callId && resolve("done"));
      client.on("serviceCallFailure", (event) => event.callId === callId && resolve(event.message));
      const data = new TextEncoder().encode(JSON.stringify(request));
      client.sendServiceCallRequest({ serviceId: service.id, callId, encoding: "json", data });
    });
  // Sets a parameter; returns the value that the program tells then, and the refusal, if there is one.
  const set = async (name, value) => {
    const id = `${name}=${value}`;
    const refusals = events.status.length;
    client.setParameters([{ name, value }], id);
    const told = await until(id, () => events.parameterValues.find((each) => each.id === id));
    const refusal = events.status.slice(refusals).find(({ level }) => level === 2);
    return { value: told.parameters[0]?.value, refusal: refusal?.message };
  };
  const valueOf = async (name, wanted) => {
    client.subscribeParameterUpdates([name]);
    return until(`${name} = ${wanted}`, () => {
      client.getParameters([name], `get ${events.parameterValues.length}`);
      const last = events.parameterValues.flatMap(({ parameters }) => parameters).filter((each) => each.name === name);
      return last.at(-1)?.value === wanted ? wanted : undefined;
    });
  };
  return { services: services.map(({ name }) => name).sort(), call, set, valueOf, close: () => client.close() };
}

async function hardware(port, name, more) {
  const out = path.join(folder, name);
  const set = ["--set", `robot.port=${port}`, "--set", "camera.driver=none", "--set", "robot.speed_scale=0.8"];
  const live = ["--live", "--port", "0", "--out", out, ...more];
  const { match, program } = await begin(hw, ["loopback", ...set, ...live], /^live at (http:\S+)$/);
  return { url: match[1], out, program };
}

async function checkWatching(port) {
  const run = await hardware(port, "watching", []);
  const viewer = await view(run.url);
  assert.deepEqual(
    viewer.services.filter((name) => !name.startsWith("/control")),
    ["/run/end", "/servo/hold"],
  );
  const { value, refusal } = await viewer.set("servo.lambda", 1);
  assert.ok(refusal, "a viewer may not change a gain");
  assert.notEqual(value, 1);
  run.program.stdin.write("enable\n");
  await run.program.says(/^enabled$/);
  let held = await viewer.call("/servo/hold", {});
  while (/no connection to the robot yet/.test(held)) held = await viewer.call("/servo/hold", {});
  assert.equal(held, "done");
  await run.program.says(/^hold/); // a run that never leaves Boot is no success
  assert.equal(await viewer.call("/run/end", {}), "done");
  assert.equal(await viewer.call("/run/end", {}).catch(() => "done"), "done", "a second time changes nothing");
  assert.equal(await run.program.exited, 0);
  assert.deepEqual([...new Set(touchesOf(await read(run.out, ["/operator"])))], ["hold", "end"]);
  console.log(`watching: hold and end only; a gain is refused: ${refusal}`);
}

async function checkControl(port) {
  const run = await hardware(port, "control", ["--live-control"]);
  const viewer = await view(run.url);
  const offered = viewer.services.filter((name) => !name.startsWith("/control"));
  assert.deepEqual(offered, ["/run/end", "/servo/hold", "/servo/recover", "/servo/track"]);
  let refused = await viewer.call("/servo/track", {});
  while (/no connection/.test(refused)) refused = await viewer.call("/servo/track", {});
  assert.match(refused, /motion is not enabled/);
  run.program.stdin.write("enable\n");
  await run.program.says(/^enabled$/);
  assert.equal(await viewer.call("/servo/track", {}), "done");
  const begun = await viewer.set("servo.lambda", 1.5);
  assert.equal(begun.refusal, undefined);
  await viewer.valueOf("servo.lambda", 1.5);
  const { refusal } = await viewer.set("robot.speed_scale", 0.9);
  assert.match(refusal, /robot\.speed_scale must be a number from 0\.01 to 0\.8/);
  await viewer.set("robot.speed_scale", 0.4);
  await viewer.valueOf("robot.speed_scale", 0.4);
  const above = await viewer.set("servo.lambda", 1.4);
  assert.match(above.refusal, /servo\.lambda = 1\.4 is not allowed: at robot\.speed_scale = 0\.4 at most/);
  await viewer.set("servo.lambda", 0.1);
  await viewer.valueOf("servo.lambda", 0.1);
  await viewer.set("robot.speed_scale", 0.3);
  await viewer.valueOf("robot.speed_scale", 0.3);
  assert.equal(await viewer.call("/servo/recover", {}), "done");
  await pause(500);
  await viewer.call("/run/end", {});
  assert.equal(await run.program.exited, 1, "without a camera it could not track");
  const all = await read(run.out, ["/servo/tick", "/setup", "/operator"]);
  const configured = all.filter(({ topic }) => topic === "/setup").map(({ message }) => message.lambda);
  const tunings = all.flatMap(({ message }) => message.tuning ?? []);
  assert.deepEqual(touchesOf(all), ["track", "speed", "speed", "recover", "end"]);
  const asked = tunings.map(({ asked }) => asked);
  console.log(`control: lambda ${configured[0]} at a speed scale of 0.8; asked ${asked.join(", ")}`);
  assert.equal(asked[0], 1.5);
  assert.ok(Math.abs(asked[1] - configured[0] / 2) < 1e-9, "half the speed scale is at most half the gain");
  assert.equal(asked[2], 0.1, "a smaller gain stays");
  assert.equal(asked.length, 3);
}

try {
  const served = await begin(
    sim,
    ["serve", "ball", "--pace", "lockstep", "--most-speed", "1", "--fci-port", "0", "--camera-serial", ""],
    /127\.0\.0\.1:(\d+),/,
  );
  await checkWatching(served.match[1]);
  await checkControl(served.match[1]);
  served.program.kill("SIGTERM");
  assert.equal(await served.program.exited, 0);
} finally {
  for (const program of running) program.kill("SIGKILL");
}
console.log("the hardware program's page is complete");
