// SPDX-License-Identifier: Apache-2.0
// Checks of each part of a report (curves, numbers, marks, texts), called with a drawn page.
import assert from "node:assert/strict";

// For each plot of the part `id` and each entry of its legend: the number
// of pixels with that entry's colour. An empty curve has none.
function curvePixels(page, id) {
  return page.evaluate((part) => {
    const near = (data, i, [r, g, b]) =>
      data[i + 3] > 200 && Math.hypot(data[i] - r, data[i + 1] - g, data[i + 2] - b) < 40;
    return [...document.querySelectorAll(`#${part} .plot`)].flatMap((plot) => {
      const layers = [...plot.querySelectorAll("canvas")];
      if (!layers.length) return [];
      const copy = document.createElement("canvas");
      copy.width = layers[0].width;
      copy.height = layers[0].height;
      const context = copy.getContext("2d");
      layers.forEach((layer) => context.drawImage(layer, 0, 0));
      const { data } = context.getImageData(0, 0, copy.width, copy.height);
      return [...plot.querySelectorAll(".legend button")].map((entry) => {
        const colour = getComputedStyle(entry.querySelector(".swatch")).color.match(/\d+/g).map(Number);
        let count = 0;
        for (let i = 0; i < data.length; i += 4) count += near(data, i, colour) ? 1 : 0;
        return { name: entry.innerText.trim(), count };
      });
    });
  }, id);
}

// `covered`: curves may cover each other, for example those of a one-joint arm, most of which are 0.
async function checkCurves(page, id, least, covered = false) {
  await page.locator(`#${id}`).scrollIntoViewIfNeeded();
  const curves = await curvePixels(page, id);
  assert.ok(curves.length >= least, `#${id}: ${curves.length} curves, at least ${least} expected`);
  const drawn = ({ count }) => count > 15;
  if (covered) assert.ok(curves.some(drawn), `#${id}: a curve is drawn`);
  else
    for (const curve of curves)
      assert.ok(drawn(curve), `#${id}: the curve "${curve.name}" is drawn (${curve.count} pixels)`);
  return curves.length;
}

// The feature paths: long lines, with start, end and goal marked.
async function checkFeatures(page) {
  const seen = await page.evaluate(() => {
    const drawing = document.querySelector(".feature-svg");
    const count = (name) => drawing.querySelectorAll(name).length;
    return {
      runs: Fovea.runs.length,
      lengths: [...drawing.querySelectorAll(".feature-line")].map((line) => line.getTotalLength()),
      starts: count(".feature-start"),
      ends: count(".feature-end"),
      goals: count(".feature-goal"),
      cells: [...document.querySelectorAll("#features tbody td")].map((cell) => cell.innerText),
    };
  });
  const paths = seen.lengths.length;
  assert.ok(paths >= seen.runs && seen.lengths.every((length) => length > 20), "each feature has a path");
  assert.deepEqual([seen.starts, seen.ends, seen.goals], [paths, paths, paths], "start, end and goal are marked");
  assert.ok(seen.cells.length >= 4 * paths && seen.cells.every((text) => /\d/.test(text)), "and listed in numbers");
}

// Curves chosen with the keyboard only are drawn and kept in the address.
async function checkFreePlot(page) {
  const search = page.locator("#free input[type=search]");
  await search.fill("joint 1 velocity");
  await search.press("ArrowDown");
  await page.keyboard.press("Space");
  await search.fill("joint 1 position");
  await search.press("Enter");
  await checkCurves(page, "free", 2);
  const hash = await page.evaluate(() => location.hash);
  assert.match(hash, /^#free\?show=/);
  const plots = await page.locator("#free .plot").count();
  assert.equal(plots, 2, "one plot for each unit");
  await page.reload();
  await page.locator('#free[data-drawn="true"]').waitFor({ state: "attached", timeout: 120_000 });
  assert.equal(await page.evaluate(() => location.hash), hash);
  await checkCurves(page, "free", 2);
  await page.locator("#free").getByText("Choose none").click();
  assert.equal(await page.locator("#free .plot").count(), 0);
}

// Tiles and time axis show the same frame counts.
async function checkFrames(page) {
  const tiles = await page.evaluate(() =>
    Object.fromEntries(
      [...document.querySelectorAll(".tile")].map((tile) => [
        tile.querySelector("dt").innerText,
        tile.querySelector(".value").innerText,
      ]),
    ),
  );
  const counted = await page.evaluate(() => {
    const [run] = Fovea.runs;
    return { lost: Fovea.frameCount(run.lost), empty: Fovea.frameCount(run.not_found) };
  });
  assert.equal(tiles["Frames lost"], String(counted.lost));
  assert.equal(tiles["Frames without target"], String(counted.empty));
  return counted;
}

// Rows without events are folded into one line until they are unfolded.
async function checkTimeline(page) {
  const rows = () => page.locator("#timeline .row-name").count();
  const folded = await rows();
  const line = await page.locator("#timeline .quiet-rows").innerText();
  assert.match(line, /never active: .*torque/i);
  const button = page.locator("#timeline .quiet-rows button");
  await button.press("Enter");
  assert.ok((await rows()) > folded, "folded rows can be shown");
  await button.press("Enter");
  assert.equal(await rows(), folded);
}

// Modes are shaded and explained in every plot over time.
async function checkBands(page, parts) {
  for (const id of parts) {
    const words = await page.locator(`#${id} .mode-legend`).first().innerText();
    assert.match(words, /track|move|hold/, `#${id}: the shading is explained`);
  }
}

// An injected fault appears on the plots, in their legend and on the time axis.
async function checkInjected(page) {
  assert.match(await page.locator("#error .mode-legend").innerText(), /injected fault/);
  const edges = await page.evaluate(() => {
    const alarm = getComputedStyle(document.documentElement).getPropertyValue("--alarm").trim().slice(1);
    const colour = [0, 2, 4].map((i) => parseInt(alarm.slice(i, i + 2), 16));
    return [...document.querySelectorAll("#error .plot, #components .plot, #velocity .plot, #joints .plot")].map(
      (plot) => {
        const canvas = plot.querySelector("canvas");
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        let count = 0;
        for (let i = 0; i < data.length; i += 4)
          if (data[i + 3] > 150 && Math.hypot(...colour.map((c, k) => c - data[i + k])) < 50) count++;
        return count;
      },
    );
  });
  assert.ok(edges.length >= 7 && edges.every((count) => count > 100), `bands are drawn: ${edges}`);
  const row = await page.locator("#timeline .span.injected title").allTextContents();
  assert.ok(row.length >= 1 && row.every((text) => /frame loss/.test(text)), "the time axis has a row for it");
}

// For a commanded circle, the path error matches the summary.
async function checkPathError(page) {
  await checkCurves(page, "way", 1);
  const { most, said } = await page.evaluate(() => {
    const [{ ticks, summary, config }] = Fovea.runs;
    const lead = Number(/^lead_s = (.*)$/m.exec(config)[1]);
    const values = ticks.path_error_mm.filter((v, i) => ticks.t_s[i] >= lead && Number.isFinite(v));
    return { most: Math.max(...values), said: summary.path_error_mm_max };
  });
  console.log(`path error at most ${most} mm by the joints, ${said} mm by the truth`);
  assert.ok(Math.abs(most - said) < 0.1 * said + 0.05, "the errors from joints and from truth agree");
}

// Texts: why no tick can overrun, which limit acted, how to repeat the run.
async function checkWords(page, command) {
  const about = await page.locator("#about").innerText();
  const { names, lockstep, slow, acted, limits } = await page.evaluate(() => ({
    names: Fovea.runs.map((run) => run.name),
    lockstep: Fovea.runs.every((run) => run.summary.pace === "lockstep"),
    slow: Fovea.runs.some((run) => run.summary.tick_ns.max > 1e6),
    limits: Fovea.runs.flatMap((run) => Object.keys(run.summary.limit_ticks || {})).map((name) => Fovea.words(name)),
    acted: Fovea.runs.some((run) => Object.values(run.summary.limit_ticks || {}).some((ticks) => ticks > 0)),
  }));
  for (const name of names) assert.ok(about.includes(name), "the footer names the run");
  assert.match(about, /Fovea \d+\.\d+/);
  assert.match(await page.locator("#about .repeat code").first().innerText(), command);
  if (lockstep && slow) assert.match(await page.locator("#ticks").innerText(), /simulated clock waits for the servo/);
  if (lockstep && names.length === 1)
    assert.match(await page.locator("#verdict").innerText(), /in lockstep the simulated clock waits/);
  const shown = await page.locator("#joints .shares dt").allTextContents();
  for (const name of limits) assert.ok(shown.includes(name), `the limit that acted is shown: ${name}`);
  if (acted)
    assert.match(
      await page.locator("#joints .shares").innerText(),
      /the servo's limit safety\.\w+ = [\d.]+ on .* acted in \d+ ticks? \([\d.]+ s\)/,
    );
}

// On paper the configuration is folded: the differences from the defaults suffice.
async function checkPaper(page) {
  const open = await page.evaluate(() => {
    dispatchEvent(new Event("beforeprint"));
    const list = [...document.querySelectorAll("#config details")];
    const seen = list.filter((node) => node.open && node.innerText.split("\n").length > 60).length;
    dispatchEvent(new Event("afterprint"));
    return seen;
  });
  assert.equal(open, 0, "no long listing is printed");
}

export {
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
};
