// SPDX-License-Identifier: Apache-2.0
// Opens the page of `fovea compare` in a wide and a narrow window. Checks that every part is drawn, that nothing is fetched,
// that the console is silent and that nothing overflows. Saves screenshots.
//   node open_difference.mjs COMPARE.html FOLDER
import assert from "node:assert/strict";
import path from "node:path";

import { openPage, plotsDrawn, sideways, withBrowser } from "./browser.mjs";

const [difference, folder] = process.argv.slice(2, 4);
const texts = (page, selector) => page.locator(selector).allInnerTexts();

await withBrowser(async (context) => {
  for (const size of [
    [1280, 900],
    [400, 800],
  ]) {
    const { page, said, asked } = await openPage(context, difference, size, [
      "causes",
      "torques",
      "positions",
      "figures",
    ]);
    await page.evaluate(() => window.scrollTo(0, 0));
    await page.screenshot({ path: path.join(folder, `difference-${size[0]}.png`), fullPage: true });
    const causes = await texts(page, "#causes tbody tr");
    console.log(`${size[0]} px: ${causes.join("; ")}`);
    assert.deepEqual(said, [], "the console is silent");
    assert.deepEqual(asked, [], "nothing is fetched");
    assert.equal(await sideways(page), 0, "nothing overflows to the side");
    assert.ok((await plotsDrawn(page, "torques")) >= 2, "the torques are drawn");
    assert.ok((await plotsDrawn(page, "positions")) >= 1, "the positions are drawn");
    assert.equal(causes.length, 7, "a row for each joint");
    assert.equal((await texts(page, "#figures tbody tr")).length, 28, "four quantities of each joint");
    assert.match(causes[1], /load \d+ % \(-0\.2/, "the load that the log's arm does not have");
    assert.match(await page.locator("#subtitle").innerText(), /with arm\.load_mass=0\.5/, "the settings are named");
    await page.close();
  }
});
console.log("the page of the comparison is complete");
