// SPDX-License-Identifier: Apache-2.0
// A server that speaks the live page's protocol and plays a recorded log in a loop. Only the tests of the page use it:
// they run against it where no program is built, and against a real run otherwise.
import fs from "node:fs";
import http from "node:http";
import path from "node:path";

import { protobufFromBinaryDescriptor } from "@mcap/support";
import { WebSocketServer } from "ws";

import { readLog } from "./read_mcap.mjs";

const LATCHED = ["/setup", "/servo/configuration", "/scene", "/camera/calibration", "/live/state", "/live/parameters"];
const ONCE = new Set(["/setup", "/servo/configuration", "/scene", "/camera/calibration"]);
const TICK_MS = 10; // between two ticks that viewers get
const LIBRARIES = "/usr/share/javascript";
const TYPES = { ".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8", ".css": "text/css" };
const SERVICES =
  "/servo/hold /servo/track /servo/recover /run/pause /run/step /run/speed /run/reset /run/save /run/end";
const MORE = "/fault/start /fault/stop /arm/pull /arm/release /target/throw /control/take /control/give";
const NAMES = `${SERVICES} ${MORE}`.split(" ");
const FREE = new Set(["/servo/hold", "/control/take"]);

const fault = (name, words, ...settings) => ({ name, words, active: false, settings });
const size = (name, words, unit, max, value) => ({ name, words, unit, min: 0, max, value });
const FAULTS = () => [
  fault("frame_loss", "pictures are lost", size("frame_loss", "share of lost pictures", "", 1, 0.5)),
  fault("camera_frozen", "the camera repeats one picture"),
  fault("load", "an unknown load at the hand", size("load_mass", "its mass", "kg", 5, 1)),
  fault("arm_silent", "the arm's states stop"),
  fault(
    "delay",
    "pictures come late",
    size("delay_s", "delay", "s", 0.5, 0.1),
    size("jitter_s", "its jitter", "s", 0.1, 0),
  ),
  fault("noise", "noise in the encoders", size("noise_rad", "standard deviation", "rad", 0.01, 0.001)),
];
const number = (name, unit, meaning, min, max, value) => ({ name, unit, meaning, min, max, value, default: value });
const PARAMETERS = () => [
  number("servo.lambda", "1/s", "Rate at which the image error shall decay", 0.1, 20, 2),
  number("servo.stale_s", "s", "Age above which a measurement is not used", 0.02, 1, 0.2),
  number("safety.cartesian_speed", "m/s", "Greatest speed of the hand", 0.01, 2, 1),
  number("camera.noise_sigma", "", "Noise of the picture, in grey values", 0, 50, 2),
];

export class StandIn {
  // `run`: folder of a run; `share`: share/fovea of a build.
  static async start({ run, share, port = 0, token = "t0ken" }) {
    const one = new StandIn(token, share);
    await one.#load(path.join(run, "log.mcap"));
    await new Promise((resolve) => one.http.listen(port, "127.0.0.1", resolve));
    one.url = `http://127.0.0.1:${one.http.address().port}/?token=${token}`;
    one.timer = setInterval(() => one.#advance(), TICK_MS);
    return one;
  }

  constructor(token, share) {
    this.token = token;
    this.share = share;
    this.received = []; // every service call, parameter and published message
    this.clients = new Set();
    this.http = http.createServer((request, response) => this.#file(request, response));
    const sockets = new WebSocketServer({
      server: this.http,
      handleProtocols: (names) => [...names].find((name) => /^foxglove\.(sdk|websocket)\.v1$/.test(name)) || false,
      verifyClient: ({ req }) => new URL(req.url, "http://x").searchParams.get("token") === this.token,
    });
    sockets.on("connection", (socket) => this.#greet(socket));
    this.#restart();
  }

  #restart() {
    this.t = 0; // run time [s]
    this.clock = performance.now();
    this.next = 0;
    this.round = 0;
    this.state = { speed: 1, paused: false, ends: false, notice: "", hold: false, controller: null };
    this.faults = FAULTS();
    this.parameters = PARAMETERS();
    this.target = null;
    this.pull = null;
  }

  stop() {
    clearInterval(this.timer);
    for (const { socket } of this.clients) socket.terminate();
    return new Promise((resolve) => this.http.close(resolve));
  }

  async #load(file) {
    const { channels, messages } = await readLog(file);
    this.channels = [...channels.values()].map(({ topic, schema }, i) => ({
      id: i + 1,
      topic,
      encoding: "protobuf",
      schemaName: schema.name,
      schema: Buffer.from(schema.data).toString("base64"),
      schemaEncoding: "protobuf",
      type: protobufFromBinaryDescriptor(schema.data).lookupType(schema.name),
    }));
    for (const topic of ["/live/state", "/live/parameters"])
      this.channels.push({
        id: this.channels.length + 1,
        topic,
        encoding: "json",
        schemaName: topic,
        schema: "{}",
        schemaEncoding: "jsonschema",
      });
    this.byTopic = new Map(this.channels.map((channel) => [channel.topic, channel]));
    this.latched = new Map();
    const topicOf = (message) => channels.get(message.channelId).topic;
    for (const message of messages) if (ONCE.has(topicOf(message))) this.latched.set(topicOf(message), message.data);
    let last = -1e9;
    this.messages = messages
      .filter((message) => !ONCE.has(topicOf(message)))
      .map((message) => ({
        topic: topicOf(message),
        t: Number(message.logTime) / 1e9,
        ns: Number(message.logTime),
        data: message.data,
      }))
      .filter(({ topic, t }) => {
        if (topic !== "/servo/tick" && topic !== "/truth") return true;
        if (topic === "/servo/tick" && t - last >= TICK_MS / 1000 - 1e-6) last = t;
        return t === last;
      });
    this.length_ns = this.messages[this.messages.length - 1].ns + 1e6;
  }

  #file(request, response) {
    const url = new URL(request.url, "http://x");
    const report = url.pathname === "/report";
    if ((url.pathname === "/" || report) && url.searchParams.get("token") !== this.token)
      return response.writeHead(401).end("the token is missing or wrong\n");
    if (report)
      return response.writeHead(200, { "content-type": TYPES[".html"] }).end("<title>report</title>the report");
    const name = path.normalize(url.pathname === "/" ? "/index.html" : url.pathname);
    const [, first] = name.split("/");
    const root =
      first === "lib"
        ? LIBRARIES
        : first === "shared"
          ? path.join(this.share, "report")
          : path.join(this.share, "live");
    const file = path.join(root, first === "lib" ? name.slice(4) : name);
    if (!fs.existsSync(file) || !fs.statSync(file).isFile()) return response.writeHead(404).end("no such file\n");
    response.writeHead(200, { "content-type": TYPES[path.extname(file)] || "text/plain", "cache-control": "no-cache" });
    response.end(fs.readFileSync(file));
  }

  #greet(socket) {
    const client = { socket, topics: new Map(), channels: new Map(), name: `viewer ${this.clients.size + 1}` };
    this.clients.add(client);
    socket.on("close", () => {
      this.clients.delete(client);
      if (this.controls === client) this.#setController(null);
    });
    socket.on("message", (data, binary) => (binary ? this.#bytes(client, data) : this.#text(client, JSON.parse(data))));
    const say = (message) => socket.send(JSON.stringify(message));
    client.say = say;
    const capabilities = ["clientPublish", "parameters", "parametersSubscribe", "time", "services"];
    say({ op: "serverInfo", name: "fovea", capabilities, supportedEncodings: ["json"], metadata: {}, sessionId: "1" });
    say({ op: "advertise", channels: this.channels.map(({ type, ...channel }) => channel) });
    say({
      op: "advertiseServices",
      services: NAMES.map((name, i) => ({ id: i + 1, name, type: name, requestSchema: "", responseSchema: "" })),
    });
  }

  #send(client, topic, payload, ns) {
    const id = client.topics.get(topic);
    if (id === undefined || client.socket.bufferedAmount > 4e6) return;
    const head = Buffer.alloc(13);
    head.writeUInt8(1, 0);
    head.writeUInt32LE(id, 1);
    head.writeBigUInt64LE(BigInt(Math.round(ns)), 5);
    client.socket.send(Buffer.concat([head, payload]));
  }

  #sendAll(topic, payload, ns) {
    for (const client of this.clients) this.#send(client, topic, payload, ns);
  }

  #stateOf(client) {
    const { speed, paused, ends, notice, hold, controller } = this.state;
    const held = { p_BO: [0.56, 0.14, 0.04], q_BO: [1, 0, 0, 0], held: false, ...this.target };
    const state = {
      stamp_s: this.t,
      wall_s: this.t,
      mode: hold ? "hold" : this.mode || "boot",
      speed,
      paused,
      ends,
      notice,
    };
    Object.assign(state, {
      hold_reason: hold ? "not_asked" : "",
      hold_reason_words: hold ? "nobody asked it to track" : "",
    });
    Object.assign(state, {
      fault: "",
      fault_words: "",
      real_time_factor: paused ? 0 : speed || 4,
      may: {},
      controller,
    });
    Object.assign(state, { you: this.controls === client, faults: this.faults, target: held, pull: this.pull });
    Object.assign(state, {
      viewers: this.clients.size,
      tick_us: { median: 3 + Math.random(), max: 6 + 4 * Math.random() },
    });
    return Buffer.from(JSON.stringify(state));
  }

  #tellState() {
    for (const client of this.clients) this.#send(client, "/live/state", this.#stateOf(client), this.t * 1e9);
    this.told = performance.now();
  }

  // Plays what is due; times of later rounds are moved on.
  #advance() {
    const now = performance.now();
    const { paused, speed, ends } = this.state;
    if (!paused && !ends) this.#playTo(this.t + ((now - this.clock) / 1000) * (speed || 4));
    this.clock = now;
    if (now - (this.told || 0) > 100) this.#tellState();
  }

  #playTo(t) {
    this.t = t;
    for (;;) {
      if (this.next === this.messages.length) {
        this.next = 0;
        this.round++;
      }
      const message = this.messages[this.next];
      const due_ns = message.ns + this.round * this.length_ns;
      if (due_ns > t * 1e9) break;
      this.next++;
      const changes = message.topic === "/truth" && this.target;
      const moved = this.round || changes ? this.#moved(message, this.round * this.length_ns) : message.data;
      if (message.topic === "/servo/tick") this.mode = this.#modeOf(message).toLowerCase();
      this.#sendAll(message.topic, moved, due_ns);
    }
    const time = Buffer.alloc(9);
    time.writeUInt8(2, 0);
    time.writeBigUInt64LE(BigInt(Math.round(t * 1e9)), 1);
    for (const { socket } of this.clients) socket.send(time);
  }

  #modeOf({ data }) {
    const { type } = this.byTopic.get("/servo/tick");
    return type.lookupEnum("fovea.log.Mode").valuesById[type.decode(data).mode];
  }

  #moved({ topic, data }, by_ns) {
    const { type } = this.byTopic.get(topic);
    const message = type.decode(data);
    const later = (ns) => Number(ns.toString()) + by_ns;
    const stamp = (at) => {
      const ns = Number(at.seconds) * 1e9 + at.nanos + by_ns;
      at.seconds = Math.floor(ns / 1e9);
      at.nanos = ns % 1e9;
    };
    if (message.stamp_ns !== undefined && type.fields.stamp_ns) message.stamp_ns = later(message.stamp_ns);
    if (message.timestamp) stamp(message.timestamp);
    for (const transform of message.transforms || []) stamp(transform.timestamp);
    if (topic === "/truth" && this.target) [message.p_BO, message.q_BO] = [this.target.p_BO, this.target.q_BO];
    return Buffer.from(type.encode(message).finish());
  }

  #text(client, message) {
    const ops = {
      subscribe: () => {
        for (const { id, channelId } of message.subscriptions) {
          const { topic } = this.channels.find((channel) => channel.id === channelId);
          client.topics.set(topic, id);
          if (!LATCHED.includes(topic)) continue;
          const payload =
            topic === "/live/state"
              ? this.#stateOf(client)
              : topic === "/live/parameters"
                ? Buffer.from(JSON.stringify(this.parameters))
                : this.latched.get(topic);
          if (payload) this.#send(client, topic, payload, 0);
        }
      },
      advertise: () => message.channels.forEach(({ id, topic }) => client.channels.set(id, topic)),
      getParameters: () => client.say({ op: "parameterValues", parameters: this.#values(), id: message.id }),
      setParameters: () => this.#setParameters(client, message),
    };
    ops[message.op]?.();
  }

  #values() {
    return this.parameters.map(({ name, value }) => ({ name, value, type: "float64" }));
  }

  #setParameters(client, { parameters, id }) {
    for (const { name, value } of parameters) {
      this.received.push({ set: name, value });
      const known = this.parameters.find((one) => one.name === name);
      const trouble = this.#refusal(client, "");
      if (trouble) client.say({ op: "status", level: 2, message: trouble, id });
      else if (!(value >= known.min && value <= known.max))
        client.say({
          op: "status",
          level: 2,
          message: `${name} = ${value} is refused: ${known.min} to ${known.max}`,
          id,
        });
      else known.value = value;
    }
    for (const one of this.clients) one.say({ op: "parameterValues", parameters: this.#values() });
  }

  #setController(client) {
    this.controls = client;
    this.state.controller = client ? client.name : null;
    if (!client) {
      this.target &&= { ...this.target, held: false };
      this.pull = null;
    }
    this.#tellState();
  }

  #refusal(client, service) {
    if (FREE.has(service)) return "";
    if (!this.controls) this.#setController(client);
    return this.controls === client ? "" : `${this.controls.name} has control`;
  }

  #bytes(client, data) {
    const op = data.readUInt8(0);
    if (op === 1) {
      const topic = client.channels.get(data.readUInt32LE(1));
      const message = JSON.parse(data.subarray(5));
      this.received.push({ published: topic, message });
      const trouble = this.#refusal(client, topic);
      if (trouble) return client.say({ op: "status", level: 2, message: trouble });
      if (topic === "/target/pose") this.target = { ...message, held: true };
      else this.target &&= { ...this.target, held: false };
      return this.#tellState();
    }
    const [service, call, length] = [1, 5, 9].map((at) => data.readUInt32LE(at));
    const name = NAMES[service - 1];
    const request = JSON.parse(data.subarray(13 + length));
    this.received.push({ call: name, request });
    const trouble = this.#refusal(client, name);
    if (trouble) return client.say({ op: "serviceCallFailure", serviceId: service, callId: call, message: trouble });
    const answer = Buffer.from(JSON.stringify(this.#serve(client, name, request) || {}));
    const head = Buffer.alloc(17);
    head.writeUInt8(3, 0);
    [service, call, 4].forEach((value, i) => head.writeUInt32LE(value, 1 + 4 * i));
    head.write("json", 13);
    client.socket.send(Buffer.concat([head, answer]));
    this.#tellState();
  }

  #serve(client, name, request) {
    const { state } = this;
    const named = () => this.faults.find((one) => one.name === request.name);
    const services = {
      "/servo/hold": () => (state.hold = true),
      "/servo/track": () => (state.hold = false),
      "/run/pause": () => (state.paused = request.paused),
      "/run/step": () => this.#playTo(this.t + request.ticks / 1000),
      "/run/speed": () => (state.speed = request.factor),
      "/run/reset": () => {
        const { controller } = state;
        this.#restart();
        state.controller = controller;
      },
      "/run/save": () => ({ name: `ball-at-${this.t.toFixed(3)}s.toml`, toml: "[servo]\nlambda = 2\n" }),
      "/run/end": () => (state.ends = true),
      "/fault/start": () => {
        Object.assign(named(), { active: true });
        for (const setting of named().settings) setting.value = request.settings?.[setting.name] ?? setting.value;
      },
      "/fault/stop": () => (named().active = false),
      "/arm/pull": () => (this.pull = { link: request.link, to_B: request.to_B }),
      "/arm/release": () => (this.pull = null),
      "/target/throw": () => (this.target = null),
      "/control/take": () => {
        if (this.controls && this.controls !== client) return { granted: false, controller: this.controls.name };
        client.name = request.name;
        this.#setController(client);
        return { granted: true, controller: client.name };
      },
      "/control/give": () => this.#setController(null),
    };
    const result = services[name]?.();
    return typeof result === "object" ? result : {};
  }
}
