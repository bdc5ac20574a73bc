// SPDX-License-Identifier: Apache-2.0
// The connection to the server, in Foxglove's WebSocket protocol. It comes back by itself after it was lost.
import { decoder } from "./protobuf.js";

const NAMES = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
const SILENT_MS = 4000; // the server sends the time each 50 ms; when nothing comes for so long, the connection is lost
const CALL_MS = 8000; // a service answers within this time
const ALIVE_MS = 3000;
const ENDED_MS = 5000; // between two tries after the run's end: a program may be started again at the same port
const GOING_AWAY = 1001; // the server closes with this code when the run has ended
const OP = { message: 1, time: 2, response: 3 }; // binary, from the server
const CLIENT_OP = { message: 1, request: 2 };

const utf8 = { from: new TextDecoder(), to: new TextEncoder() };
const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

export class Connection {
  #socket = null;
  #heard = 0;
  #tries = 0;
  #timer = 0;
  #topics = new Map(); // topic to callback
  #channels = new Map(); // id to channel
  #reads = new Map(); // subscription's id to {read, callback}
  #services = new Map(); // name to id
  #calls = new Map(); // call's id to {resolve, reject, timer}
  #published = new Map(); // topic to the id of our own channel
  #count = 0;
  #listeners = Fovea.callbacks();

  // `url`: ws://... with the token.
  constructor(url) {
    this.url = url;
    this.state = "connecting"; // connecting, open, lost, ended
    this.lostAt = 0;
    this.keepAlive = false; // whether to send a sign of life
    setInterval(() => this.#watch(), 500);
    setInterval(() => this.keepAlive && this.#send({ op: "getParameters", parameterNames: [], id: "alive" }), ALIVE_MS);
    addEventListener("online", () => this.state === "lost" && this.connect());
  }

  // Kinds: state, services, status {level, message}, parameters [{name, value}].
  listen(callback) {
    return this.#listeners.listen(callback);
  }

  // Calls `callback(message, time [ns])` with each message of a topic.
  subscribe(topic, callback) {
    this.#topics.set(topic, callback);
  }

  connect() {
    clearTimeout(this.#timer);
    if (this.#socket) this.#drop();
    this.#tries++;
    this.#heard = performance.now();
    const socket = new WebSocket(this.url, NAMES);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.#opened();
    socket.onmessage = ({ data }) => {
      this.#heard = performance.now();
      if (typeof data === "string") this.#text(JSON.parse(data));
      else this.#binary(new DataView(data));
    };
    socket.onclose = ({ code }) => socket === this.#socket && this.#lost(code === GOING_AWAY);
    this.#socket = socket;
  }

  has(service) {
    return this.#services.has(service);
  }

  // The answer of a service. Rejects with one sentence that says why it was refused.
  call(name, request = {}) {
    const service = this.#services.get(name);
    if (this.state !== "open") return Promise.reject(new Error("Not sent: there is no connection."));
    if (service === undefined) return Promise.reject(new Error(`This run does not offer ${name}.`));
    const id = ++this.#count;
    const encoding = utf8.to.encode("json");
    const payload = utf8.to.encode(JSON.stringify(request));
    const frame = new DataView(new ArrayBuffer(13 + encoding.length + payload.length));
    frame.setUint8(0, CLIENT_OP.request);
    frame.setUint32(1, service, true);
    frame.setUint32(5, id, true);
    frame.setUint32(9, encoding.length, true);
    new Uint8Array(frame.buffer).set(encoding, 13);
    new Uint8Array(frame.buffer).set(payload, 13 + encoding.length);
    this.#socket.send(frame);
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => this.#answer(id, null, `${name} got no answer.`), CALL_MS);
      this.#calls.set(id, { resolve, reject, timer });
    });
  }

  setParameter(name, value) {
    this.#send({ op: "setParameters", parameters: [{ name, value, type: "float64" }], id: `set ${name}` });
  }

  // Sends a message on a channel of our own.
  publish(topic, message) {
    if (this.state !== "open") return;
    if (!this.#published.has(topic)) {
      const id = ++this.#count;
      this.#published.set(topic, id);
      this.#send({ op: "advertise", channels: [{ id, topic, encoding: "json", schemaName: topic.slice(1) }] });
    }
    const payload = utf8.to.encode(JSON.stringify(message));
    const frame = new DataView(new ArrayBuffer(5 + payload.length));
    frame.setUint8(0, CLIENT_OP.message);
    frame.setUint32(1, this.#published.get(topic), true);
    new Uint8Array(frame.buffer).set(payload, 5);
    this.#socket.send(frame);
  }

  #send(message) {
    if (this.state === "open") this.#socket.send(JSON.stringify(message));
  }

  #opened() {
    this.state = "open";
    this.#tries = 0;
    this.#send({ op: "getParameters", parameterNames: [], id: "all" });
    this.#send({ op: "subscribeParameterUpdates", parameterNames: [] });
    this.#listeners.tell("state");
  }

  #drop(trouble = "The connection was lost before the answer came.") {
    const socket = this.#socket;
    this.#socket = null;
    socket.onmessage = socket.onclose = socket.onopen = null;
    socket.close();
    this.#channels.clear();
    this.#reads.clear();
    this.#services.clear();
    this.#published.clear();
    for (const id of [...this.#calls.keys()]) this.#answer(id, null, trouble);
  }

  // An ended run stays ended until a program answers again.
  #lost(byEnd) {
    const ended = byEnd || this.state === "ended";
    this.#drop(ended ? "The run has ended." : undefined);
    if (this.state !== "lost") this.lostAt = performance.now();
    this.state = ended ? "ended" : "lost";
    this.#listeners.tell("state");
    clearTimeout(this.#timer);
    const wait = ended ? ENDED_MS : Math.min(3000, 300 * 2 ** Math.min(this.#tries, 5));
    this.#timer = setTimeout(() => this.connect(), wait);
  }

  #watch() {
    if (this.#socket && performance.now() - this.#heard > SILENT_MS) this.#lost(false);
  }

  #answer(id, result, trouble) {
    const call = this.#calls.get(id);
    if (!call) return;
    this.#calls.delete(id);
    clearTimeout(call.timer);
    if (trouble) call.reject(new Error(trouble));
    else call.resolve(result);
  }

  #text(message) {
    const ops = {
      advertise: () => this.#advertised(message.channels),
      unadvertise: () => message.channelIds.forEach((id) => this.#channels.delete(id)),
      advertiseServices: () => {
        for (const { id, name } of message.services) this.#services.set(name, id);
        this.#listeners.tell("services");
      },
      unadvertiseServices: () => {
        for (const [name, id] of this.#services) if (message.serviceIds.includes(id)) this.#services.delete(name);
        this.#listeners.tell("services");
      },
      serviceCallFailure: () => this.#answer(message.callId, null, message.message),
      parameterValues: () => this.#listeners.tell("parameters", message.parameters),
      status: () => this.#listeners.tell("status", message),
    };
    ops[message.op]?.();
  }

  #advertised(channels) {
    const subscriptions = [];
    for (const channel of channels) {
      this.#channels.set(channel.id, channel);
      const callback = this.#topics.get(channel.topic);
      if (!callback) continue;
      const json = channel.encoding === "json";
      const read = json
        ? (bytes) => JSON.parse(utf8.from.decode(bytes))
        : decoder(bytesOf(channel.schema), channel.schemaName);
      const id = ++this.#count;
      this.#reads.set(id, { read, callback });
      subscriptions.push({ id, channelId: channel.id });
    }
    if (subscriptions.length) this.#send({ op: "subscribe", subscriptions });
  }

  #binary(frame) {
    const op = frame.getUint8(0);
    const rest = (from) => new Uint8Array(frame.buffer, from);
    if (op === OP.message) {
      const subscription = this.#reads.get(frame.getUint32(1, true));
      if (subscription) subscription.callback(subscription.read(rest(13)), Number(frame.getBigUint64(5, true)));
    } else if (op === OP.response) {
      const text = utf8.from.decode(rest(13 + frame.getUint32(9, true)));
      this.#answer(frame.getUint32(5, true), text ? JSON.parse(text) : {}, null);
    }
  }
}
