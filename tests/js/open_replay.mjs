// SPDX-License-Identifier: Apache-2.0
// Opens the page of a replay in a wide and a narrow window. Checks that every part is drawn, that both runs are there,
// that nothing is fetched, that the console is silent and that nothing overflows. Saves screenshots.
//   node open_replay.mjs REPLAY.html FOLDER
import assert from "node:assert/strict";
import path from "node:path";

import { openPage, plotsDrawn, sideways, withBrowser } from "./browser.mjs";

const [replay, folder] = process.argv.slice(2, 4);
const texts = (page, selector) => page.locator(selector).allInnerTexts();

await withBrowser(async (context) => {
  for (const size of [
    [1280, 900],
    [400, 800],
  ]) {
    const { page, said, asked } = await openPage(context, replay, size, ["motion", "joints", "modes", "changes"]);
    await page.evaluate(() => window.scrollTo(0, 0));
    await page.screenshot({ path: path.join(folder, `replay-${size[0]}.png`), fullPage: true });
    const runs = await page.evaluate(() =>
      Fovea.runs.map((run) => ({ ticks: run.t_s.length, joints: run.tau.length })),
    );
    const modes = await texts(page, "#modes tbody tr");
    const changes = await texts(page, "#changes tbody tr");
    console.log(`${size[0]} px: ${JSON.stringify(runs)}, ${modes.length} modes, ${changes.length} changes`);
    assert.deepEqual(said, [], "the console is silent");
    assert.deepEqual(asked, [], "nothing is fetched");
    assert.equal(await sideways(page), 0, "nothing overflows to the side");
    assert.ok((await plotsDrawn(page, "motion")) >= 2, "the commands to the hand are drawn");
    assert.ok((await plotsDrawn(page, "joints")) >= 2, "the commands to the joints are drawn");
    assert.equal(runs.length, 2, "the recorded run and the replayed one");
    assert.ok(runs.every((run) => run.ticks > 100 && run.joints >= 1));
    assert.deepEqual(runs[0], runs[1]);
    assert.match(await page.locator("#subtitle").innerText(), /B, dashed: with \S+=/, "the settings are named");
    for (const run of ["A", "B"]) {
      assert.ok(
        modes.some((row) => row.startsWith(run) && /track$/.test(row)),
        `${run} tracks`,
      );
    }
    assert.ok(
      changes.some((row) => /^dq_cmd\[/.test(row)),
      "a velocity differs",
    );
    await page.close();
  }
});
console.log("the replay page is complete");
