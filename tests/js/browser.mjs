// Pages in a browser, as a person would open them: what they fetch, and what they complain of.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

import { chromium } from "playwright-core";

// Calls `look(context)` with a browser that is gone afterwards.
export async function withBrowser(look) {
  const program = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(fs.existsSync);
  assert.ok(program, "Chromium is there (tools/install test)");
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
    ],
  });
  // Drawn by a software renderer, on a machine that is busy with the other tests.
  context.setDefaultTimeout(120_000);
  try {
    await look(context);
  } finally {
    await context.close();
    fs.rmSync(home, { recursive: true, force: true });
  }
}

// The file opened in a window of that size, each of its `parts` looked at until it is drawn. `said`: what its
// console says; `asked`: what it fetches.
export async function openPage(context, file, [width, height], parts) {
  const url = pathToFileURL(path.resolve(file)).href;
  const page = await context.newPage();
  await page.setViewportSize({ width, height });
  const said = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) said.push(message.text());
  });
  page.on("pageerror", (error) => said.push(String(error)));
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

// How many plots of the page's part `id` are drawn: those whose pixels differ.
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

// By how much it sticks out to the side [px].
export function sideways(page) {
  return page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
}
