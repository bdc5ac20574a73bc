// SPDX-License-Identifier: Apache-2.0
// A run whose names (scenario, arm, joints, configuration) all contain injected HTML. The report must show them as
// text, must run no script from them and must send no request, even if told to.
//   node hostile_report.mjs FOVEA_SIM FOVEA ROBOTS FOLDER
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import http from "node:http";
import path from "node:path";
import { pathToFileURL } from "node:url";

import { withBrowser } from "./browser.mjs";

const [sim, fovea, robots, folder] = process.argv.slice(2, 6);
const bait = `<img src=x onerror="window.stolen=1">`;
const scripts = `</script><script>window.stolen=2</script><!--<b>`;
const escaped = (text) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

fs.rmSync(folder, { recursive: true, force: true });
const own = path.join(folder, "theirs");
fs.mkdirSync(own, { recursive: true });
// An arm with such names for its joints, tip and file.
let urdf = fs.readFileSync(path.join(robots, "panda.urdf"), "utf8");
urdf = urdf.replaceAll(`"panda_joint1"`, `"${escaped(bait)}"`).replaceAll(`"panda_joint2"`, `"${escaped(scripts)}"`);
urdf = urdf.replaceAll(`"panda_flange"`, `"${escaped(bait)}flange"`);
assert.ok(urdf.includes("window.stolen=1") && urdf.includes("window.stolen=2"));
fs.writeFileSync(path.join(own, "panda.urdf"), urdf);
const arm = fs
  .readFileSync(path.join(robots, "panda.toml"), "utf8")
  .replace("panda_flange", `${bait.replaceAll('"', '\\"')}flange`);
fs.writeFileSync(path.join(own, `${bait}.toml`), arm);
// A file name cannot contain a slash; a description can.
const scenario = path.join(own, `${bait}run.toml`);
const text = [`[arm]`, `model = '${bait}.toml'`, `[run]`, `description = '${scripts}'`, `duration_s = 0.3`];
fs.writeFileSync(scenario, text.join("\n"));

function run(program, ...args) {
  const done = spawnSync(program, args, { encoding: "utf8", timeout: 100_000 });
  assert.ok(done.status === 0 || done.status === 1, `${program}: ${done.status} ${done.stderr}`);
}
const out = path.join(folder, "out");
run(sim, "run", scenario, "--out", out);
const replay = spawnSync(fovea, ["replay", out], { encoding: "utf8", timeout: 100_000 });
assert.equal(replay.status, 0, replay.stdout + replay.stderr);
const both = path.join(folder, "both.html");
run(fovea, "report", out, out, "--out", both);

// A server that the page could contact.
let calls = 0;
const listener = http.createServer((_, answer) => {
  calls += 1;
  answer.writeHead(200, { "Access-Control-Allow-Origin": "*" });
  answer.end();
});
await new Promise((go) => listener.listen(0, "127.0.0.1", go));
const there = `http://127.0.0.1:${listener.address().port}/`;

await withBrowser(async (context) => {
  for (const report of [path.join(out, "report.html"), both]) {
    const url = pathToFileURL(report).href;
    const page = await context.newPage();
    const asked = [];
    page.on("request", (request) => {
      if (request.url() !== url && !/^(data|blob):/.test(request.url())) asked.push(request.url());
    });
    const trouble = [];
    page.on("pageerror", (error) => trouble.push(String(error)));
    await page.goto(url);
    for (const part of ["verdict", "path", "joints", "timeline", "ticks", "config"]) {
      await page.locator(`#${part}`).scrollIntoViewIfNeeded();
      await page.locator(`#${part}[data-drawn="true"]`).waitFor({ state: "attached", timeout: 120_000 });
    }
    assert.deepEqual(asked, [], "the page sends no request");
    const seen = await page.evaluate(async (where) => {
      const image = new Image();
      await Promise.all([
        fetch(where).catch(() => null),
        new Promise((go) => {
          image.onload = image.onerror = go;
          image.src = where;
        }),
      ]);
      return {
        stolen: window.stolen ?? null,
        title: document.title,
        words: document.body.textContent,
        baits: document.querySelectorAll("[onerror], img[src='x'], b").length,
      };
    }, there);
    assert.equal(seen.stolen, null, "no script from a name was run");
    assert.equal(seen.baits, 0, "no name became a page element");
    assert.ok(seen.title.includes(bait) && seen.words.includes(bait), "names are shown unchanged");
    assert.ok(seen.words.includes(scripts), "also those of a joint and a description");
    assert.deepEqual(trouble, []);
    assert.equal(calls, 0, "the page sends no request even if told to");
    await page.close();
  }
});
listener.close();
console.log("all names are shown as text");
