// SPDX-License-Identifier: Apache-2.0
// Opens the live page in a browser and uses it as a person does. With a URL it tests the page of a program that runs;
// otherwise that of a stand-in server, which plays the log of RUN.
//   node open_live.mjs URL FOLDER
//   node open_live.mjs RUN SHARE FOLDER     (SHARE: share/fovea of a build)
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";

import { listenTo, sideways, withBrowser } from "./browser.mjs";
import * as checks from "./live_checks.mjs";
import { StandIn } from "./live_standin.mjs";

const given = process.argv.slice(2);
const real = /^http:/.test(given[0]);
const server = real ? null : await StandIn.start({ run: given[0], share: given[1] });
const url = real ? given[0] : server.url;
const folder = given[given.length - 1];
fs.mkdirSync(folder, { recursive: true });

// Opens the page, waits until pictures come, and returns it with its console messages and the frames that it sent.
async function open(context, { size = [1440, 900], scheme = "light", route = null }) {
  const page = await context.newPage();
  await page.setViewportSize({ width: size[0], height: size[1] });
  await page.emulateMedia({ colorScheme: scheme });
  const said = listenTo(page);
  const sent = [];
  page.on("websocket", (socket) => socket.on("framesent", ({ payload }) => sent.push(Buffer.from(payload))));
  if (route) await page.routeWebSocket(/./, route);
  await page.goto(url);
  await checks.waitForPictures(page, 3);
  return { page, said, sent };
}

const steps = [
  ["the page opens, moves and fits", checks.checkMotion],
  ["every plot has its curves", checks.checkPlots],
  ["sliders set parameters, and refuse what is no number of their range", checks.checkTuning],
  ["faults start and stop", checks.checkFaults],
  ["pause, step and speed", checks.checkTime],
  ["the past can be looked at", checks.checkPast],
  ["hold and track", checks.checkHold],
  ["save and report", checks.checkSave],
  ["the target is dragged", checks.checkTarget],
  ["the arm is pulled", checks.checkPull],
  ["keys alone suffice", checks.checkKeys],
];

try {
  await withBrowser(async (context) => {
    const { page, said, sent } = await open(context, {});
    for (const [words, check] of steps) {
      await check(page, sent, folder);
      console.log(`ok: ${words}`);
    }
    const other = await open(context, {});
    await checks.checkControl(page, other.page);
    console.log("ok: one client has control");
    await other.page.close();
    assert.deepEqual([...said, ...other.said], [], "the console is silent");
    await page.close();

    const gate = checks.gate();
    const cut = await open(context, { route: gate.route });
    await checks.checkReconnect(cut.page, gate);
    console.log("ok: the page connects again by itself");
    await cut.page.close();

    for (const [size, scheme] of [
      [[400, 850], "light"],
      [[400, 850], "dark"],
      [[1440, 900], "dark"],
    ]) {
      const { page: one, said: words } = await open(context, { size, scheme });
      await one.waitForTimeout(1500);
      await one.screenshot({ path: path.join(folder, `live-${size[0]}-${scheme}.png`), fullPage: true });
      assert.equal(await sideways(one), 0, `${size[0]} px: nothing overflows to the side`);
      await checks.checkContrast(one);
      assert.deepEqual(words, [], "the console is silent");
      await one.close();
    }
    console.log("ok: narrow and dark");
  });
} finally {
  await server?.stop();
}
console.log("the live page is complete");
