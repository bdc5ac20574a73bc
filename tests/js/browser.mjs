// SPDX-License-Identifier: Apache-2.0
// Opens pages in a browser as a user does; reports what they fetch and their console errors.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

import { chromium } from "playwright-core";

// Calls `look(context)` with a browser, and closes the browser afterwards.
export async function withBrowser(look) {
  const program = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(fs.existsSync);
  assert.ok(program, "Chromium is installed (tools/install test)");
  const home = fs.mkdtempSync(path.join(os.tmpdir(), "fovea-report-"));
  const context = await chromium.launchPersistentContext(home, {
    executablePath: program,
    headless: true,
    args: [
      "--no-sandbox",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      "--use-gl=angle",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--disable-gpu-compositing", // the software renderer draws the 3-D views only: the page is drawn twice as fast
    ],
  });
  // A software renderer draws the page, on a machine that is busy with other tests.
  context.setDefaultTimeout(120_000);
  try {
    await look(context);
  } finally {
    await context.close();
    fs.rmSync(home, { recursive: true, force: true });
  }
}

// The errors and warnings that the page writes to the console from now on. A page may wait for a picture to know how long
// it takes: Chromium then says once that a read of its pixels stalls, which is the purpose.
export function listenTo(page) {
  const said = [];
  page.on("console", (message) => {
    const onPurpose = /GL Driver Message .*GPU stall due to ReadPixels/.test(message.text());
    if (["error", "warning"].includes(message.type()) && !onPurpose) said.push(message.text());
  });
  page.on("pageerror", (error) => said.push(String(error.stack)));
  return said;
}

// Opens the file in a window of that size and scrolls to each of its `parts` until it is drawn. Returns the page, its
// console messages (`said`) and the URLs that it requested (`asked`).
export async function openPage(context, file, [width, height], parts) {
  const url = pathToFileURL(path.resolve(file)).href;
  const page = await context.newPage();
  await page.setViewportSize({ width, height });
  const said = listenTo(page);
  const asked = [];
  page.on("request", (request) => {
    if (request.url() !== url && !/^(data|blob):/.test(request.url())) asked.push(request.url());
  });
  await page.goto(url);
  for (const part of parts) {
    await page.locator(`#${part}`).scrollIntoViewIfNeeded();
    await page.locator(`#${part}[data-drawn="true"]`).waitFor({ state: "attached", timeout: 120_000 });
  }
  return { page, said, asked };
}

// Number of drawn plots in the page's part `id`, that is, plots whose pixels differ.
export function plotsDrawn(page, id) {
  return page.evaluate((part) => {
    const drawn = (canvas) => {
      const copy = document.createElement("canvas");
      copy.width = canvas.width;
      copy.height = canvas.height;
      const context = copy.getContext("2d");
      context.drawImage(canvas, 0, 0);
      const pixels = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
      return pixels.some((value) => value !== pixels[0]);
    };
    return [...document.querySelectorAll(`#${part} canvas`)].filter((c) => c.width > 0 && drawn(c)).length;
  }, id);
}

// Horizontal overflow of the page [px].
export function sideways(page) {
  return page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
}
