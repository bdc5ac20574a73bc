// SPDX-License-Identifier: Apache-2.0
// Opens a report in a wide and a narrow window, and on paper. Checks that every part is drawn, that nothing is fetched,
// that the console is silent and that nothing overflows. Saves screenshots.
//   node open_report.mjs REPORT.html FOLDER [theory|hardware|circle|faults]
import assert from "node:assert/strict";
import path from "node:path";

import { openPage, plotsDrawn, sideways, withBrowser } from "./browser.mjs";
import {
  checkBands,
  checkCurves,
  checkFeatures,
  checkFrames,
  checkFreePlot,
  checkInjected,
  checkPaper,
  checkPathError,
  checkTimeline,
  checkWords,
} from "./report_parts.mjs";

const [report, folder] = process.argv.slice(2, 4);
const name = path.basename(report, ".html");

// Checks that `act` changes the pixels of `place`.
async function changes(place, what, act) {
  await place.scrollIntoViewIfNeeded();
  const before = await place.evaluate((canvas) => canvas.toDataURL());
  await act();
  for (const end = Date.now() + 5000; Date.now() < end; await new Promise((go) => setTimeout(go, 100))) {
    if ((await place.evaluate((canvas) => canvas.toDataURL())) !== before) return;
  }
  assert.fail(what);
}

// A run without a camera has no "eye" sections. Theory and circle runs have a section of their own. A hardware run has
// no ground truth, and the page says so. `faults`: a run with injected frame loss.
const asked = process.argv[4] ?? "eye";
const hardware = asked === "hardware";
const kind = ["hardware", "faults"].includes(asked) ? "eye" : asked;
const own = { eye: ["eye", "error", "components", "features", "beliefs"], theory: ["theory"], circle: ["way"] }[kind];
const parts = ["verdict", ...own, "path", "velocity", "joints", "timeline", "free", "ticks", "config", "about"];
await withBrowser(async (context) => {
  for (const [width, height] of [
    [1280, 900],
    [400, 800],
  ]) {
    const { page, said, asked: fetched } = await openPage(context, report, [width, height], parts);
    const seen = await page.evaluate(() => {
      const videos = [...document.querySelectorAll("video")];
      // Distance between a drawn path and the points that it must pass.
      const astray = Fovea.runs
        .filter((run) => run.scene)
        .flatMap((run) => [run.scene.camera_path, run.scene.target_path])
        .filter(Boolean)
        .map((flat) => {
          const known = [];
          for (let i = 0; i + 2 < flat.length; i += 3) {
            if (Number.isFinite(flat[i] + flat[i + 1] + flat[i + 2]))
              known.push(new THREE.Vector3(...flat.slice(i, i + 3)));
          }
          const drawn = new THREE.Box3().setFromObject(Fovea.armScene.path(flat, "--blue", false, 0.001));
          const through = new THREE.Box3().setFromPoints(known);
          return drawn.isEmpty() ? 0 : drawn.min.distanceTo(through.min) + drawn.max.distanceTo(through.max);
        });
      return {
        runs: Fovea.runs.length,
        astray: Math.max(0, ...astray),
        marks: Object.fromEntries(
          ["ticks", "timeline"].map((id) => [
            id,
            [...document.querySelectorAll(`#${id} svg :is(rect, path, line, circle)`)].filter((mark) => {
              const box = mark.getBoundingClientRect();
              return box.width + box.height > 1;
            }).length,
          ]),
        ),
        words: document.querySelector("#verdict").innerText.length,
        images: [...document.querySelectorAll("#eye img, #eye image")].length,
        videos: videos.map((v) => v.error === null && v.duration),
        absent: [...document.querySelectorAll(".absent")].map((p) => p.innerText),
      };
    });
    seen.sideways = await sideways(page);
    seen.plots = {};
    for (const id of ["error", "theory", "path", "joints"]) seen.plots[id] = await plotsDrawn(page, id);
    console.log(`${width} px: ${JSON.stringify(seen)}`);
    await page.evaluate(() => window.scrollTo(0, 0));
    await page.screenshot({ path: path.join(folder, `${name}-${width}.png`), fullPage: true });
    assert.deepEqual(said, [], "the console is silent");
    assert.deepEqual(fetched, [], "nothing is fetched");
    assert.ok(seen.words > 100);
    assert.ok(seen.astray < 0.02, "paths are where the log has them");
    assert.ok(seen.plots.path >= 1 && seen.plots.joints >= 3, "plots are drawn");
    if (kind === "eye") {
      assert.ok(seen.plots.error >= 1, "the error is drawn");
      assert.ok(seen.images >= 2, "first and last frame");
      assert.ok(seen.videos.length >= 1, "there is a film");
      assert.ok(
        seen.videos.every((duration) => duration > 1),
        "the film can be played",
      );
    } else {
      if (kind === "theory")
        assert.ok(seen.plots.theory >= 2, "the response, the analytic one and their difference are drawn");
      assert.equal(seen.images + seen.videos.length, 0, "no camera");
    }
    assert.ok(seen.marks.ticks >= 10 && seen.marks.timeline >= 3, "histogram and time axis are drawn");
    assert.equal(seen.sideways, 0, "nothing overflows to the side");
    assert.equal(seen.absent.length, hardware ? 1 : 0, "a complete run lacks nothing");
    assert.ok(seen.absent.every((words) => /the log holds no truth/.test(words)));
    const curved = kind === "eye" ? ["error", "components"] : own;
    await checkBands(page, [...curved, "velocity", "joints", "timeline", "free"]);
    await checkCurves(page, "velocity", 2, kind === "theory");
    await checkWords(page, hardware ? /^fovea-hw / : /^fovea-sim run /);
    if (kind === "eye") {
      await checkCurves(page, "components", 3);
      await checkFeatures(page);
      const frames = seen.runs === 1 ? await checkFrames(page) : null;
      if (asked === "faults") {
        assert.ok(frames.lost > 0, "lost frames are counted");
        await checkInjected(page);
      }
    }
    if (kind === "circle") await checkPathError(page);
    if (width === 1280) {
      await checkTimeline(page);
      await checkPaper(page);
      if (kind === "eye") {
        await changes(page.locator("#error canvas").first(), "a logarithmic scale changes the plot", () =>
          page.locator("#error").getByText("Logarithmic").click(),
        );
      }
      const scene = page.locator("#path canvas");
      await changes(scene, "dragging rotates the 3-D view", async () => {
        const box = await scene.boundingBox();
        await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
        await page.mouse.down();
        await page.mouse.move(box.x + 0.7 * box.width, box.y + 0.55 * box.height, { steps: 5 });
        await page.mouse.up();
      });
      const pdf = await page.pdf({ path: path.join(folder, `${name}.pdf`), format: "A4", printBackground: true });
      console.log(`on paper: ${pdf.toString("latin1").match(/\/Type \/Page\b/g).length} pages`);
      await checkFreePlot(page);
    }
    await page.close();
  }
});
console.log("the report is complete");
