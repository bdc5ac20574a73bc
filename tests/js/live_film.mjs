// SPDX-License-Identifier: Apache-2.0
// Takes the pictures of the project's moving picture of the live page: the target is dragged away with the mouse, and the
// arm follows. Prints their rate.
//   node live_film.mjs FOVEA-SIM FOLDER
import { spawn } from "node:child_process";
import { once } from "node:events";
import fs from "node:fs";
import path from "node:path";
import { createInterface } from "node:readline";

import { withBrowser } from "./browser.mjs";
import { waitForPictures } from "./live_checks.mjs";
import { targetAt } from "./live_mouse.mjs";

const [sim, folder] = process.argv.slice(2);
fs.rmSync(folder, { recursive: true, force: true });
fs.mkdirSync(folder, { recursive: true });
const options = ["run", "ball", "--live", "--port", "0", "--out", path.join(folder, "run")];
const program = spawn(sim, options, { stdio: ["ignore", "ignore", "pipe"] });
const [line] = await once(createInterface({ input: program.stderr }), "line");

// How far the mouse is from where it took the target, in pixels of the window, at each picture.
const still = (count, x, y) => Array(count).fill([x, y]);
const way = (count, from, to) =>
  [...Array(count).keys()].map((i) => from.map((x, k) => x + ((to[k] - x) * (i + 1)) / count));
const OUT = [70, -20];
const BACK = [-40, 10];
const PATH = [...way(10, [0, 0], OUT), ...still(10, ...OUT), ...way(12, OUT, BACK), ...still(12, ...BACK)];

try {
  await withBrowser(async (context) => {
    const page = await context.newPage();
    await page.setViewportSize({ width: 1200, height: 760 });
    await page.goto(line.slice("live at ".length));
    await waitForPictures(page, 3);
    await page.waitForFunction(() => parseFloat(document.querySelector(".when").textContent) > 5);
    // Pictures of the page take long where no GPU is.
    await page.getByLabel("Speed of the simulation").selectOption("0.25");
    await page.waitForTimeout(1500);
    const at = await targetAt(page);
    await page.mouse.move(at.x, at.y);
    await page.waitForTimeout(300);
    await page.mouse.down();
    const time = () => page.evaluate(() => parseFloat(document.querySelector(".when").textContent));
    const begin = await time();
    for (const [i, [x, y]] of PATH.entries()) {
      await page.mouse.move(at.x + x, at.y + y);
      await page.screenshot({ path: path.join(folder, `${String(i).padStart(3, "0")}.png`) });
    }
    await page.mouse.up();
    console.log(`${(PATH.length / ((await time()) - begin)).toFixed(1)} pictures per second of the run`);
  });
} finally {
  program.kill("SIGINT");
  await once(program, "exit");
}
