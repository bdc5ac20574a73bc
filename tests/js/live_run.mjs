// SPDX-License-Identifier: Apache-2.0
// A person's session with the real simulator, in a browser: the target is dragged with the mouse, lambda is changed,
// every fault's button is pressed, the state is saved. The run's log then says what happened.
//   node live_run.mjs FOVEA-SIM FOLDER
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import fs from "node:fs";
import path from "node:path";
import { createInterface } from "node:readline";

import { protobufFromBinaryDescriptor } from "@mcap/support";

import { listenTo, withBrowser } from "./browser.mjs";
import { texts, waitForPictures, waitForText } from "./live_checks.mjs";
import { targetAt, untilBenchStands } from "./live_mouse.mjs";
import { readLog } from "./read_mcap.mjs";

const [sim, folder] = process.argv.slice(2);
fs.rmSync(folder, { recursive: true, force: true });
fs.mkdirSync(folder, { recursive: true });
const running = new Set();

// Starts a live run with its files in `name`. `end()` ends it as Ctrl-C does, and returns its summary.
async function begin(scenario, name, more = []) {
  const out = path.join(folder, name);
  const program = spawn(sim, ["run", scenario, "--live", "--port", "0", "--out", out, ...more], {
    stdio: ["ignore", "ignore", "pipe"],
  });
  running.add(program);
  const lines = createInterface({ input: program.stderr });
  const [line] = await once(lines, "line");
  const [, url] = line.match(/^live at (http:\/\/127\.0\.0\.1:\d+\/\?token=\S+)$/);
  const end = async () => {
    program.kill("SIGINT");
    if (program.exitCode === null) await once(program, "exit");
    running.delete(program);
    return JSON.parse(fs.readFileSync(path.join(out, "summary.json"), "utf8"));
  };
  return { url, out, end };
}

// The log's messages of the topics, each {t [s], data}.
async function read(out, topics) {
  const { channels, messages } = await readLog(path.join(out, "log.mcap"));
  const types = new Map();
  const found = Object.fromEntries(topics.map((topic) => [topic, []]));
  for (const { channelId, logTime, data } of messages) {
    const { topic, schema } = channels.get(channelId);
    if (!found[topic]) continue;
    if (!types.has(topic)) types.set(topic, protobufFromBinaryDescriptor(schema.data).lookupType(schema.name));
    found[topic].push({ t: Number(logTime) * 1e-9, data: types.get(topic).decode(data) });
  }
  return found;
}

async function open(context, url) {
  const page = await context.newPage();
  await page.setViewportSize({ width: 1440, height: 900 });
  const said = listenTo(page);
  const sent = [];
  page.on("websocket", (socket) => socket.on("framesent", ({ payload }) => sent.push(Buffer.from(payload))));
  await page.goto(url);
  await waitForPictures(page, 3);
  return { page, said, sent };
}

const SLOW = 0.25; // times real time
const SHOWN_S = 0.02; // the page shows rounded times
const runTime = (page) => page.evaluate(() => parseFloat(document.querySelector(".when").textContent));
const untilTime = (page, t) =>
  page.waitForFunction((end) => parseFloat(document.querySelector(".when").textContent) >= end, t);

// Drags the target with the mouse, sideways in the window, until it is `metres` away. Each step of the mouse waits for
// the page's own answer, so that a slow computer does not let the mouse run ahead.
async function dragTarget(page, sent, metres, direction) {
  await page.getByRole("button", { name: "Move target" }).click();
  await page.locator("#bench canvas").scrollIntoViewIfNeeded();
  await untilBenchStands(page);
  const from = sent.length;
  const poses = () =>
    texts(sent.slice(from))
      .filter((text) => /"p_BO"/.test(text))
      .map((text) => JSON.parse(text).p_BO);
  const at = await targetAt(page);
  await page.mouse.move(at.x, at.y);
  await page.waitForTimeout(150);
  await page.mouse.down();
  let way = 0;
  for (let i = 1; i <= 200 && way < metres; i++) {
    const before = poses().length;
    await page.mouse.move(at.x + direction * 10 * i, at.y);
    for (const end = performance.now() + 500; poses().length === before && performance.now() < end; )
      await page.waitForTimeout(20);
    const drawn = poses();
    if (drawn.length) way = Math.hypot(...drawn.at(-1).map((x, k) => x - drawn[0][k]));
  }
  await page.mouse.up();
  assert.ok(way >= metres && way < metres + 0.05, `the mouse moved the target by ${way} m`);
}

async function setLambda(page, value) {
  const field = page.locator('[data-name="servo.lambda"] .number-field');
  await field.fill(String(value));
  await field.press("Enter");
  await page.waitForTimeout(500); // it has its ramp
}

// The true errors from the last move of the target (faster than 5 mm/s) that begins after `from` and before `to`.
function afterMove(truths, from, to) {
  const part = truths.filter(({ t }) => t >= from && t < to);
  let rest = -1;
  for (let i = 1; i < part.length; i++)
    if (part[i].data.p_BO.some((x, k) => Math.abs(x - part[i - 1].data.p_BO[k]) > 5e-6)) rest = i;
  assert.ok(rest > 0, "the target moved");
  assert.ok(Math.max(...part.map(({ data }) => data.error_px)) > 10, "the drag disturbed the servo");
  return part.slice(rest);
}

// The largest error from 3 s on [px].
function lateError(after) {
  const late = after.filter(({ t }) => t >= after[0].t + 3.0);
  assert.ok(late.length > 0, "the run lasts 3 s after the drag");
  return Math.max(...late.map(({ data }) => data.error_px));
}

// The error's time constant between 70 % and 15 % of the first error [s].
function timeConstant(after) {
  const first = after[0].data.error_mm;
  const fit = after.slice(
    after.findIndex(({ data }) => data.error_mm < 0.7 * first),
    after.findIndex(({ data }) => data.error_mm < 0.15 * first),
  );
  assert.ok(fit.length > 20, "the error falls");
  const mean = (list) => list.reduce((sum, x) => sum + x, 0) / list.length;
  const [t0, y0] = [mean(fit.map(({ t }) => t)), mean(fit.map(({ data }) => Math.log(data.error_mm)))];
  const slope =
    mean(fit.map(({ t, data }) => (t - t0) * (Math.log(data.error_mm) - y0))) / mean(fit.map(({ t }) => (t - t0) ** 2));
  return -1 / slope;
}

async function press(page, button, shows) {
  await page.locator(button).click();
  await waitForText(page, button, shows);
}

// The rate of the eye's pictures on the page over `seconds` [1/s], and how fast the run was.
async function pictureRate(page, seconds) {
  const count = () => page.evaluate(() => Number(document.querySelector("#eye canvas").dataset.pictures));
  const [wall, run, pictures] = [performance.now(), await runTime(page), await count()];
  await page.waitForTimeout(1000 * seconds);
  const passed = (performance.now() - wall) / 1000;
  return { rate: ((await count()) - pictures) / passed, speed: ((await runTime(page)) - run) / passed };
}

const setPace = (page, factor) => page.getByLabel("Speed of the simulation").selectOption(String(factor));

async function checkDragAndLambda(context) {
  // The law alone, whose time constant is measured: after a quick drag a plan would take over.
  const run = await begin("ball", "drag", ["--set", "servo.plans=false"]);
  const { page, said, sent } = await open(context, run.url);
  await untilTime(page, 5.0);
  // The camera makes 30 in each second of the run. Slowed down, the page must show most of them on a slow computer, too.
  await setPace(page, SLOW);
  const { rate, speed } = await pictureRate(page, 10);
  await setPace(page, 1);
  console.log(`${rate.toFixed(1)} pictures/s on the page, the run at ${speed.toFixed(2)} times real time`);
  assert.ok(speed > 0.5 * SLOW && speed < 1.5 * SLOW, "the run has the chosen speed");
  assert.ok(rate / speed > 20, "the camera's picture moves");
  const marks = [];
  for (const [lambda, direction] of [
    [2, 1],
    [4, -1],
  ]) {
    await setLambda(page, lambda);
    marks.push((await runTime(page)) - SHOWN_S);
    await waitForPictures(page, 1);
    await dragTarget(page, sent, 0.1, direction);
    await untilTime(page, (await runTime(page)) + 4.0);
    // Back while the run is paused: for the arm that is one quick move, however slow this computer is.
    await press(page, ".pause", /Run/);
    marks.push((await runTime(page)) - SHOWN_S);
    await dragTarget(page, sent, 0.1, -direction);
    await press(page, ".pause", /Pause/);
    await untilTime(page, (await runTime(page)) + 4.0);
  }
  const waiting = page.waitForEvent("download");
  await page.getByRole("button", { name: "Save", exact: true }).click();
  const saved = path.join(folder, "saved.toml");
  await (await waiting).saveAs(saved);
  await page.screenshot({ path: path.join(folder, "drag.png") });
  await page.close();
  await run.end();
  assert.deepEqual(said, [], "the console is silent");
  checkReplay(run.out);
  const { "/truth": truths, "/operator": touches } = await read(run.out, ["/truth", "/operator"]);
  const drags = marks.map((mark, i) => afterMove(truths, mark, marks[i + 1] ?? Infinity));
  for (const [i, after] of drags.entries()) {
    const [at_px, late_px] = [after[0].data.error_px, lateError(after)];
    console.log(
      `lambda ${i < 2 ? 2 : 4}: ${at_px.toFixed(1)} px at rest, at most ${late_px.toFixed(2)} px from 3 s on`,
    );
    if (i % 2) assert.ok(at_px > 15, "a drag in a pause is a step for the arm");
    assert.ok(late_px < 1, "the error is under 1 px within 3 s of letting go");
  }
  const [two, four] = [timeConstant(drags[1]), timeConstant(drags[3])];
  console.log(`time constant: ${(1e3 * two).toFixed(0)} ms, with lambda 4 ${(1e3 * four).toFixed(0)} ms`);
  assert.ok(four / two > 0.45 && four / two < 0.55, "lambda 4 halves the time constant");
  const told = touches.map(({ data }) => data.text);
  for (const words of [/^the target is taken/, /^the target is let go/])
    assert.ok(told.filter((text) => words.test(text)).length >= 2, `both drags are in the log: ${told.join("; ")}`);
  return { saved, truths, rate };
}

// The servo's replay gives the same bits, whatever was touched.
function checkReplay(out) {
  const fovea = path.join(path.dirname(sim), "fovea");
  const done = spawnSync(fovea, ["replay", out, "--json"], { stdio: ["ignore", "pipe", "inherit"] });
  const { identical, complete } = JSON.parse(done.stdout);
  assert.deepEqual([done.status, identical, complete], [0, true, true], `replay of ${path.basename(out)}`);
}

// A saved scenario begins where the run was.
async function checkSaved({ saved, truths }) {
  const out = path.join(folder, "again");
  spawnSync(sim, ["run", saved, "--set", "run.duration_s=0.2", "--out", out], { stdio: "ignore" });
  const { "/truth": again } = await read(out, ["/truth"]);
  const time = parseFloat(fs.readFileSync(saved, "utf8").match(/as it was after ([\d.]+) s/)[1]);
  const was = truths.find(({ data }) => Math.abs(data.stamp_ns * 1e-9 - time) < 6e-4);
  const apart = (name) => Math.hypot(...was.data[name].map((x, i) => x - again[0].data[name][i]));
  console.log(`saved at ${time} s: target ${apart("p_BO")} m, camera ${apart("p_BC")} m from where they were`);
  assert.ok(apart("p_BO") < 1e-9 && apart("p_BC") < 1e-4);
}

// The summary of the same time without a page, with other keys of the scenario.
async function withoutPage(duration_s, settings = {}, name = "without-page", scenario = "ball") {
  const all = { ...settings, "run.duration_s": duration_s };
  const set = Object.entries(all).flatMap(([key, value]) => ["--set", `${key}=${value}`]);
  const options = ["run", scenario, ...set, "--no-report", "--json", "--out", path.join(folder, name)];
  const program = spawn(sim, options, { stdio: ["ignore", "pipe", "ignore"] });
  running.add(program);
  let json = "";
  for await (const piece of program.stdout) json += piece;
  running.delete(program);
  return JSON.parse(json);
}

async function checkUntouched(context) {
  const run = await begin("ball", "untouched");
  const { page } = await open(context, run.url);
  await untilTime(page, 1.5);
  const watched = await run.end();
  await page.getByText("The run has ended.").waitFor();
  assert.ok(await page.locator(".note-bar.bad").isHidden(), "the run's end is no lost connection");
  await page.close();
  const alone = await withoutPage(watched.sim_time_s);
  console.log(`${watched.ticks} ticks with a viewer: log_hash ${watched.log_hash}; without: ${alone.log_hash}`);
  assert.deepEqual([watched.ticks, watched.log_hash], [alone.ticks, alone.log_hash]);
}

// Each fault's button starts and stops its fault: both are in the log, and the ticks are, bit by bit, those of a scenario
// with these faults. A fault acts from the tick after its request on.
const TICK_S = 0.001;
// Some faults act in their own run only: an earlier scene looks like the present one where nothing moves, an arm that
// a fault before has stopped seldom feels its weight, and a planner is asked when the target has jumped: there the fault
// goes on until then. The last run has all others.
const JUMP = { "target.motion": "jump", "target.jump": "[0.1, 0.1, 0.0]", "target.jump_s": "3" };
const FAULT_RUNS = [
  { group: "earlier-scenes", scenario: "ball-moving", faults: ["freeze", "replay"] },
  { group: "body", scenario: "ball", faults: ["gravity", "load", "push", "torque_loss"] },
  { group: "planner", scenario: "ball", faults: ["planner_loss"], keys: JUMP, until: 4 },
  { group: "rest", scenario: "ball" },
];
async function checkFaults(context, { group, scenario, faults, keys: scene = {}, until = 0 }) {
  const set = Object.entries(scene).flatMap(([key, value]) => ["--set", `${key}=${value}`]);
  const run = await begin(scenario, `faults-${group}`, set);
  const { page, said } = await open(context, run.url);
  await untilTime(page, 0.5);
  await setPace(page, SLOW); // the time between two clicks is then less of the run's, which is repeated often below
  const all = await page.locator("#faults li[data-fault]").evaluateAll((rows) => rows.map((one) => one.dataset.fault));
  assert.ok(all.length > 15, `${all.length} faults`);
  const elsewhere = FAULT_RUNS.flatMap((other) => other.faults ?? []);
  const unknown = elsewhere.filter((name) => !all.includes(name));
  assert.deepEqual(unknown, [], "each fault of a run has a button");
  const names = faults ?? all.filter((name) => !elsewhere.includes(name));
  for (const name of names) {
    const row = page.locator(`#faults li[data-fault="${name}"]`);
    if (name === "push") {
      await row.locator("summary").click();
      await row.locator("input.number-field").nth(1).fill("5");
      await row.locator("input.number-field").nth(1).press("Enter");
    }
    for (const state of [".active", ":not(.active)"]) {
      await row.locator("button").first().click();
      await page.locator(`#faults li[data-fault="${name}"]${state}`).waitFor();
      // In the run's own time, which a slow computer stretches: nine pictures or more, of which a fault may hit half.
      if (state === ".active") await untilTime(page, Math.max(until, (await runTime(page)) + SHOWN_S + 0.3));
    }
  }
  await page.screenshot({ path: path.join(folder, `faults-${group}.png`) });
  await page.close();
  const summary = await run.end();
  assert.deepEqual(said, [], "the console is silent");
  checkReplay(run.out);
  const { "/operator": touches } = await read(run.out, ["/operator"]);
  const timesOf = (pattern) =>
    touches.filter(({ data }) => pattern.test(data.text)).map(({ data }) => Number(data.stamp_ns) * 1e-9);
  const settings = { ...scene, "faults.push": "[0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0]" };
  for (const name of names) {
    const started = timesOf(new RegExp(`^fault ${name}(,|$)`));
    const stopped = timesOf(new RegExp(`^fault ${name} stopped$`));
    assert.deepEqual([started.length, stopped.length], [1, 1], `${name} is in the log`);
    settings[`faults.${name}_s`] = `[${(started[0] + TICK_S).toFixed(9)}, ${(stopped[0] + TICK_S).toFixed(9)}]`;
  }
  const keys = await withoutPage(summary.sim_time_s, settings, "by-keys", scenario);
  console.log(`${names.length} faults, ${group}, by buttons: log_hash ${summary.log_hash}; by keys: ${keys.log_hash}`);
  assert.deepEqual([keys.ticks, keys.log_hash], [summary.ticks, summary.log_hash]);
  // Each of them has its effect: with it alone, at its time, the ticks are others than without any fault. (All others
  // less one would not show it: a fault before may have stopped the arm.)
  const faultless = { ...scene };
  const none = await withoutPage(summary.sim_time_s, faultless, "without-faults", scenario);
  const left = [...names];
  const tryAlone = async () => {
    for (let name = left.pop(); name; name = left.pop()) {
      const one = { ...faultless };
      for (const key of [`faults.${name}_s`, `faults.${name}`]) if (key in settings) one[key] = settings[key];
      const alone = await withoutPage(summary.sim_time_s, one, `only-${name}`, scenario);
      assert.notEqual(alone.log_hash, none.log_hash, `${name} has an effect`);
    }
  };
  await Promise.all([tryAlone(), tryAlone()]);
}

try {
  await withBrowser(async (context) => {
    const dragged = await checkDragAndLambda(context);
    await checkSaved(dragged);
    await checkUntouched(context);
    for (const run of FAULT_RUNS) await checkFaults(context, run);
  });
} finally {
  for (const program of running) program.kill("SIGKILL");
}
console.log("the live run is complete");
