// SPDX-License-Identifier: Apache-2.0
// Checks of the live page's parts, called with an open page. `sent`: the frames that it sent, as buffers.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";

import { sideways } from "./browser.mjs";
import { drag, letGoInMotion, targetAt, untilBenchStands, untilHandStands } from "./live_mouse.mjs";

const pictures = (page, part) =>
  page.evaluate((id) => Number(document.querySelector(`#${id} canvas`)?.dataset.pictures || 0), part);

// Waits until the bench and the camera have each drawn `more` pictures.
export async function waitForPictures(page, more) {
  const before = [await pictures(page, "bench"), await pictures(page, "eye")];
  await page.waitForFunction(
    ([bench, eye]) =>
      Number(document.querySelector("#bench canvas")?.dataset.pictures || 0) >= bench &&
      Number(document.querySelector("#eye canvas")?.dataset.pictures || 0) >= eye,
    before.map((count) => count + more),
  );
}

// The JSON texts that were sent: ops, service requests and published messages.
const PUBLISH = 1; // the first byte of a binary frame; a text begins with a brace
export const texts = (sent) =>
  sent.map((frame) => {
    if (frame[0] === 0x7b) return frame.toString();
    return frame.subarray(frame[0] === PUBLISH ? 5 : 13 + frame.readUInt32LE(9)).toString();
  });
async function waitForSent(page, sent, from, pattern) {
  for (let tries = 0; tries < 600; tries++) {
    const found = texts(sent.slice(from)).find((text) => pattern.test(text));
    if (found) return JSON.parse(found);
    await page.waitForTimeout(100);
  }
  throw new assert.AssertionError({ message: `nothing like ${pattern} was sent` });
}

export const waitForText = (page, selector, pattern) =>
  page.waitForFunction(
    ([where, text]) => new RegExp(text).test(document.querySelector(where)?.innerText || ""),
    [selector, pattern.source],
  );

const shownTime = (page) => page.evaluate(() => parseFloat(document.querySelector(".when").textContent));

// Pixels of an element's canvas, as one number that changes with the picture.
const fingerprint = (page, selector) =>
  page.evaluate((where) => {
    const canvas = document.querySelector(where);
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) sum = (sum * 31 + data[i] + 256 * data[i + 1]) % 1000000007;
    return sum;
  }, selector);

export async function checkMotion(page, sent, folder) {
  const title = await page.locator("#title").innerText();
  assert.ok(title.length > 1, "the scenario is named");
  const before = await fingerprint(page, "#eye canvas");
  const time = await shownTime(page);
  await waitForPictures(page, 8);
  assert.notEqual(await fingerprint(page, "#eye canvas"), before, "the camera's picture moves");
  assert.ok((await shownTime(page)) > time, "time goes on");
  assert.match(await page.locator(".chip.mode").innerText(), /^(boot|hold|track|coast|move|fault)$/);
  assert.equal(await page.locator(".chip.link").innerText(), "connected");
  assert.equal(await sideways(page), 0, "nothing overflows to the side");
  await page.screenshot({ path: path.join(folder, "live-1440-light.png") });
}

// Number of pixels of each curve's colour in its plot.
export async function checkPlots(page) {
  await page.waitForTimeout(2500);
  for (const id of ["error", "v", "omega", "joints", "torques", "age", "ticks"]) {
    await page.locator(`#plot-${id}`).scrollIntoViewIfNeeded();
    await page.waitForTimeout(1200);
    const curves = await page.evaluate((plot) => {
      const figure = document.getElementById(`plot-${plot}`);
      const canvas = figure.querySelector("canvas");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return [...figure.querySelectorAll(".legend button")].map((entry) => {
        const [r, g, b] = getComputedStyle(entry.querySelector(".swatch")).color.match(/\d+/g).map(Number);
        let count = 0;
        for (let i = 0; i < data.length; i += 4)
          if (data[i + 3] > 150 && Math.hypot(data[i] - r, data[i + 1] - g, data[i + 2] - b) < 60) count++;
        return { name: entry.innerText.trim().split("\n"), count };
      });
    }, id);
    assert.ok(curves.length >= 1, `#plot-${id} has curves`);
    const drawn = curves.filter(({ count }) => count > 12);
    assert.ok(drawn.length >= curves.length - 1, `#plot-${id}: ${JSON.stringify(curves)}`);
    // There is no age while the target is not known.
    const entries = `#plot-${id} .legend button`;
    const hasValue = (all) => [...document.querySelectorAll(all)].some((one) => /\n.*\d/.test(one.innerText.trim()));
    await page.waitForFunction(hasValue, entries);
  }
}

export async function checkTuning(page, sent) {
  const row = page.locator('[data-name="servo.lambda"]');
  const field = row.locator("input.number-field");
  const slider = row.locator("input[type=range]");
  await page.waitForFunction(() => !document.querySelector('[data-name="servo.lambda"] input').disabled);
  let from = sent.length;
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  const { parameters } = await waitForSent(page, sent, from, /"setParameters"/);
  assert.equal(parameters[0].name, "servo.lambda");
  assert.ok(Number.isFinite(parameters[0].value));
  await page.waitForFunction(
    (value) => Number(document.querySelector('[data-name="servo.lambda"] .number-field').value) === value,
    parseFloat(parameters[0].value.toPrecision(5)),
  );
  // What is no number, and what is out of the range, is refused with the range and not sent.
  for (const wrong of ["NaN", "1e9", "-5", "fast", ""]) {
    from = sent.length;
    await field.fill(wrong);
    await field.press("Enter");
    const refusal = await row.locator(".refusal").innerText();
    assert.match(refusal, /is refused: servo\.lambda takes [\d.]+ to [\d.]+/, wrong);
    assert.ok(!texts(sent.slice(from)).some((text) => /setParameters/.test(text)), "a refused value is not sent");
  }
  await field.press("Escape");
  assert.ok(await row.locator(".refusal").isHidden());
  from = sent.length;
  await field.fill("3");
  await field.press("Enter");
  assert.equal((await waitForSent(page, sent, from, /"setParameters"/)).parameters[0].value, 3);
  // A further key, by its words.
  const search = page.locator("#tuning input[type=search]");
  const rows = await page.locator(".tuned-row").count();
  await search.fill("speed");
  await search.press("Enter");
  assert.equal(await page.locator(".tuned-row").count(), rows + 1, "the search adds a key");
  await search.fill("no such key at all");
  assert.match(await page.locator(".found").innerText(), /No key/);
  await search.fill("");
}

export async function checkFaults(page, sent) {
  const first = page.locator("#faults li[data-fault]").first();
  const name = await first.getAttribute("data-fault");
  await first.scrollIntoViewIfNeeded();
  let from = sent.length;
  await first.locator("button").first().click();
  const started = await waitForSent(page, sent, from, /"name":/);
  assert.equal(started.name, name);
  await page.locator(`li[data-fault="${name}"].active`).waitFor();
  from = sent.length;
  await first.locator("button").first().click();
  assert.equal((await waitForSent(page, sent, from, /"name":/)).name, name);
  await page.locator(`li[data-fault="${name}"]:not(.active)`).waitFor();
}

export async function checkTime(page, sent) {
  let from = sent.length;
  await page.locator(".pause").click();
  assert.equal((await waitForSent(page, sent, from, /"paused"/)).paused, true);
  await waitForText(page, ".pause", /Run/);
  await page.waitForTimeout(600);
  const stopped = await shownTime(page);
  await page.waitForTimeout(800);
  assert.equal(await shownTime(page), stopped, "a paused run stands still");
  from = sent.length;
  await page.getByRole("button", { name: "Step" }).click({ modifiers: ["Shift"] });
  assert.equal((await waitForSent(page, sent, from, /"ticks"/)).ticks, 20);
  await page.waitForFunction((t) => parseFloat(document.querySelector(".when").textContent) > t, stopped);
  assert.ok((await shownTime(page)) - stopped < 0.05, "20 ticks are 20 ms");
  await page.locator(".pause").click();
  await waitForText(page, ".pause", /Pause/);
  from = sent.length;
  await page.getByLabel("Speed of the simulation").selectOption("0.1");
  assert.equal((await waitForSent(page, sent, from, /"factor"/)).factor, 0.1);
  await page.waitForFunction(() => document.querySelector(".transport-run select").value === "0.1");
  await page.getByLabel("Speed of the simulation").selectOption("1");
  await waitForPictures(page, 2);
}

export async function checkPast(page, sent, folder) {
  const slider = page.locator(".scrub");
  await slider.focus();
  for (let i = 0; i < 3; i++) await slider.press("ArrowLeft");
  await page.locator(".past-bar").waitFor();
  const keyed = await shownTime(page);
  await page.waitForTimeout(500);
  assert.ok((await shownTime(page)) <= keyed, "keys lead from live to the past, which stands still");
  await page.evaluate(() => {
    const node = document.querySelector(".scrub");
    node.value = -2;
    node.dispatchEvent(new Event("input"));
  });
  await page.locator(".past-bar").waitFor();
  assert.match(await page.locator(".past-bar").innerText(), /You look at the past: [\d.]+ s, [\d.]+ s ago/);
  await page.waitForTimeout(1000);
  const then = await fingerprint(page, "#eye canvas");
  const time = await shownTime(page);
  await page.screenshot({ path: path.join(folder, "live-past.png") });
  await page.waitForTimeout(1500);
  assert.equal(await fingerprint(page, "#eye canvas"), then, "the past stands still");
  assert.equal(await shownTime(page), time);
  await page.locator(".past-bar button").click();
  await page.locator(".past-bar").waitFor({ state: "hidden" });
  await waitForPictures(page, 3);
  assert.ok((await shownTime(page)) > time, "back to live");
}

export async function checkHold(page) {
  await page.getByRole("button", { name: "Hold", exact: true }).click();
  await waitForText(page, ".chip.mode", /hold/);
  const reason = await page.locator(".reason").innerText();
  assert.match(reason, /[a-z]+ [a-z]+/, "the reason is in words");
  assert.ok(!/_/.test(reason), reason);
  await page.getByRole("button", { name: "Track", exact: true }).click();
  await waitForText(page, ".chip.mode", /track|coast/);
}

export async function checkSave(page, sent, folder) {
  const waiting = page.waitForEvent("download");
  await page.getByRole("button", { name: "Save", exact: true }).click();
  const download = await waiting;
  assert.match(download.suggestedFilename(), /\.toml$/);
  const file = path.join(folder, "saved.toml");
  await download.saveAs(file);
  assert.match(fs.readFileSync(file, "utf8"), /^\[|=/m);
  assert.match(await page.locator("a.button").getAttribute("href"), /^report\?token=.+/);
}

export async function checkTarget(page, sent) {
  await page.locator("#bench canvas").scrollIntoViewIfNeeded();
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.getByRole("button", { name: "Move target" }).click();
  await untilBenchStands(page);
  await waitForPictures(page, 2);
  let from = sent.length;
  const at = await targetAt(page);
  await drag(page, at, { x: at.x + 50, y: at.y - 30 });
  const first = await waitForSent(page, sent, from, /"p_BO":\[.*"q_BO"/);
  assert.equal(first.p_BO.length, 3);
  assert.ok(Math.abs(Math.hypot(...first.q_BO) - 1) < 1e-6, "a quaternion of length 1");
  await page.mouse.up();
  await waitForSent(page, sent, from, /^\{\}$/);
  const poses = texts(sent.slice(from)).filter((text) => /^\{\}$|"p_BO"/.test(text));
  assert.equal(poses.pop(), "{}", "it is let go after its last pose");
  const last = JSON.parse(poses.pop());
  assert.ok(Math.hypot(...last.p_BO.map((x, i) => x - first.p_BO[i])) > 0.005, "the target was moved");
  // Thrown: it flies on with the velocity of the hand.
  await page.getByLabel("What the target does when it is let go").selectOption("throw");
  from = sent.length;
  const again = await targetAt(page);
  await drag(page, again, { x: again.x + 120, y: again.y - 40 });
  await letGoInMotion(page, again.x + 140, again.y - 47);
  const thrown = await waitForSent(page, sent, from, /"v_BO"/);
  assert.ok(Math.hypot(...thrown.v_BO) > 0.01 && Math.hypot(...thrown.v_BO) <= 5.001, JSON.stringify(thrown));
  assert.ok(!texts(sent.slice(from)).includes("{}"), "a throw is no release");
  await page.getByLabel("What the target does when it is let go").selectOption("stay");
}

// The arm of the log moves by more than the hand's size while a mouse comes to it: it is paused before it is taken.
export async function checkPull(page, sent) {
  await page.getByRole("button", { name: "Pull arm" }).click();
  await page.locator(".pause").click();
  await waitForText(page, ".pause", /Run/);
  await untilBenchStands(page);
  let from = sent.length;
  const hand = await untilHandStands(page);
  await drag(page, hand, { x: hand.x + 60, y: hand.y - 40 });
  const pull = await waitForSent(page, sent, from, /"to_B"/);
  assert.match(pull.link, /^(?!fovea)./, "a link of the robot");
  assert.ok(pull.p_link.length === 3 && pull.to_B.every(Number.isFinite), JSON.stringify(pull));
  from = sent.length;
  await page.mouse.up();
  await waitForSent(page, sent, from, /^\{\}$/);
  await page.locator(".pause").click();
  await waitForText(page, ".pause", /Pause/);
  await waitForPictures(page, 2);
  await page.getByRole("button", { name: "Look", exact: true }).click();
}

// The target is moved by keys; each control that is shown can be reached with the tabulator and has a name.
export async function checkKeys(page, sent) {
  await page.getByRole("button", { name: "Move target" }).press("Enter");
  await page.locator("#bench canvas").focus();
  const from = sent.length;
  await page.keyboard.press("ArrowUp");
  await waitForSent(page, sent, from, /"p_BO"/);
  await waitForSent(page, sent, from, /^\{\}$/);
  await page.getByRole("button", { name: "Pull arm" }).press("Enter");
  await page.locator("#bench canvas").focus();
  await page.keyboard.press("ArrowRight");
  assert.doesNotMatch((await waitForSent(page, sent, from, /"to_B"/)).link, /fovea/, "keys pull the robot's last link");
  const pulled = sent.length;
  await page.keyboard.press("Escape");
  await waitForSent(page, sent, pulled, /^\{\}$/);
  const nameless = await page.evaluate(() =>
    [...document.querySelectorAll("button, input, select, a, [tabindex]")]
      .filter((node) => node.offsetParent && node.tabIndex >= 0)
      .filter((node) => !(node.getAttribute("aria-label") || node.innerText?.trim() || node.closest("label")))
      .map((node) => node.outerHTML.slice(0, 120)),
  );
  assert.deepEqual(nameless, [], "every control has a name");
}

export async function checkControl(page, other) {
  await waitForText(page, ".who", /You have control/);
  await waitForText(other, ".who", /has control/);
  assert.doesNotMatch(await other.locator(".who").innerText(), /You have/);
  await other.locator(".pause").click();
  await waitForText(other, ".notes", /has control/);
  assert.match(await other.locator(".pause").innerText(), /Pause/, "the refused pause did not act");
  const field = other.locator(".tuned-row .number-field").first();
  const was = await field.inputValue();
  await field.fill("7");
  await field.press("Enter");
  await other.waitForFunction((value) => document.querySelector(".tuned-row .number-field").value === value, was);
  await page.getByRole("button", { name: "Give control" }).click();
  await waitForText(other, ".who", /Nobody has control/);
  await other.getByRole("button", { name: "Take control" }).click();
  await waitForText(other, ".who", /You have control/);
  await waitForText(page, ".who", /^(?!You).* has control/);
  await other.getByRole("button", { name: "Give control" }).click();
}

// Between page and server, for a network that fails: while it is shut, connections fall silent and none is made.
export function gate() {
  const self = {
    shut: false,
    tries: 0,
    route(socket) {
      self.tries++;
      if (self.shut) return socket.close({ code: 1011, reason: "no network" });
      const server = socket.connectToServer();
      socket.onMessage((message) => !self.shut && server.send(message));
      server.onMessage((message) => !self.shut && socket.send(message));
      socket.onClose((code, reason) => server.close({ code, reason }));
    },
  };
  return self;
}

export async function checkReconnect(page, gate) {
  const time = await shownTime(page);
  gate.shut = true;
  await page.locator(".note-bar.bad").waitFor();
  assert.match(
    await page.locator(".note-bar.bad").innerText(),
    /connection is lost since \d+ s.*connects again by itself/,
  );
  assert.ok(await page.locator(".pause").isDisabled(), "nothing can be asked for meanwhile");
  await page.waitForTimeout(10_000);
  const tries = gate.tries;
  assert.ok(tries >= 3 && tries < 40, `${tries} connections were tried`);
  gate.shut = false;
  await page.locator(".note-bar.bad").waitFor({ state: "hidden" });
  await waitForText(page, ".notes", /Connected again/);
  await waitForPictures(page, 3);
  assert.ok((await shownTime(page)) > time);
  await page.waitForFunction(() => !document.querySelector(".pause").disabled);
}

// Text against its background: at least 4.5 to 1 where both are plain colours.
export async function checkContrast(page) {
  const weak = await page.evaluate(() => {
    const channels = (text) => (text.match(/[\d.]+/g) || []).map(Number);
    const light = ([r, g, b]) =>
      [r, g, b]
        .map((c) => c / 255)
        .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
        .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
    const behind = (node) => {
      for (let at = node; at; at = at.parentElement) {
        const colour = channels(getComputedStyle(at).backgroundColor);
        if (colour.length === 3 || colour[3] === 1) return colour;
      }
      return [255, 255, 255];
    };
    const weak = [];
    for (const node of document.querySelectorAll("body *")) {
      const own = [...node.childNodes].some((child) => child.nodeType === 3 && child.textContent.trim());
      if (!own || !node.offsetParent || node.matches(":disabled, .unseen, option, .skip")) continue;
      const [a, b] = [light(channels(getComputedStyle(node).color)), light(behind(node))];
      const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      if (ratio < 4.5) weak.push(`${node.textContent.trim().slice(0, 40)}: ${ratio.toFixed(2)}`);
    }
    return weak;
  });
  assert.deepEqual(weak, [], "text is readable");
}
