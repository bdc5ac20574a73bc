// SPDX-License-Identifier: Apache-2.0
// The effective configuration (with two runs: what differs), versions and hashes.

Fovea.config = (function () {
  const { el, words } = Fovea;

  const listing = (text) => el("pre", { class: "listing", tabindex: "0" }, el("code", { text }));

  function whole(run, several) {
    if (!run.config) return Fovea.absent(`The log${several ? ` of run ${run.letter}` : ""} holds no configuration.`);
    const lines = run.config.split("\n").length;
    return el(
      "details",
      { class: "folded-on-paper", open: !several && lines < 40 },
      el("summary", { text: `${several ? `Run ${run.letter}: all` : "Effective configuration"} (${lines} lines)` }),
      el("div", { class: "copy-box" }, Fovea.copyButton(run.config), listing(run.config)),
    );
  }

  // The keys whose value is not the default; older logs do not contain the defaults.
  function changedKeys(run, several) {
    if (!run.changed) return null;
    const title = `Keys that differ from their defaults${several ? `, run ${run.letter}` : ""}`;
    if (!run.changed.length) return el("p", { text: `${title}: none.` });
    const rows = run.changed.map(({ key, value, default: was }) => [key, value, was]);
    return [el("h3", { text: title }), Fovea.table(["Key", "Value", "Default"], rows, { class: "keys", scroll: true })];
  }

  function changes(runs) {
    const lines = Fovea.compare.diff(runs[0].config, runs[1].config);
    const changed = lines.filter((line) => line.side !== " ");
    if (!changed.length) return el("p", { text: "The configurations of both runs are the same." });
    const block = (list) =>
      el(
        "pre",
        { class: "listing diff", tabindex: "0" },
        list.map((line) =>
          el("code", { class: `side-${line.side.trim() || "both"}`, text: `${line.side} ${line.text}\n` }),
        ),
      );
    // Shows each changed line below the header of its TOML table.
    const short = [];
    let table = "";
    let told = "";
    for (const line of lines) {
      if (/^\s*\[/.test(line.text)) table = line.text;
      if (line.side === " ") continue;
      if (table !== told && table !== line.text) short.push({ side: " ", text: table });
      told = table;
      short.push(line);
    }
    return [
      el("h3", { text: "Lines that differ" }),
      block(short),
      el(
        "details",
        { class: "folded-on-paper" },
        el("summary", { text: "All lines, with the differences marked" }),
        block(lines),
      ),
    ];
  }

  // Versions and hashes: the info map, then the values that only the summary has.
  function facts(run) {
    const map = new Map(Object.entries(run.info));
    const s = run.summary || {};
    for (const key of [
      "version",
      "git",
      "scenario",
      "seed",
      "pace",
      "renderer",
      "log_hash",
      "servo",
      "sim_time_s",
      "wall_time_s",
      "contact_ticks",
      "page_faults_in_loop",
      "records_dropped",
      "film_frames_dropped",
      "log_entries_dropped",
      "log_pictures_dropped",
    ]) {
      if (!map.has(key) && s[key] !== undefined && s[key] !== null) map.set(key, String(s[key]));
    }
    for (const key of ["realtime_missing", "film_errors"]) {
      if (Array.isArray(s[key]) && s[key].length) map.set(key, s[key].join(", "));
    }
    return map;
  }

  function versions(runs) {
    const maps = runs.map(facts);
    const keys = Array.from(new Set(maps.flatMap((map) => Array.from(map.keys()))));
    if (!keys.length) return Fovea.absent("The log names no versions.");
    const several = runs.length > 1;
    const text = keys.map((key) => `${key}: ${maps.map((map) => map.get(key) || "–").join("  |  ")}`).join("\n");
    const rows = keys.map((key) => {
      const differs = several && maps[0].get(key) !== maps[1].get(key);
      return el(
        "div",
        { class: differs ? "fact differs" : "fact" },
        el("dt", { text: words(key) }),
        several && !differs
          ? el("dd", { text: maps[0].get(key) })
          : maps.map((map, i) =>
              el("dd", {}, several ? el("strong", { text: `${runs[i].letter} ` }) : null, map.get(key) || "–"),
            ),
      );
    });
    return [
      el("div", { class: "facts-head" }, el("h3", { text: "Versions and hashes" }), Fovea.copyButton(text)),
      el("dl", { class: "facts" }, rows),
    ];
  }

  function draw(runs) {
    const body = document.querySelector("#config .body");
    const several = runs.length > 1;
    if (several && runs.every((run) => run.config)) body.append(...[changes(runs)].flat());
    body.append(
      ...runs.flatMap((run) => changedKeys(run, several) || []),
      ...runs.map((run) => whole(run, several)),
      ...[versions(runs)].flat(),
    );
    Fovea.drawn("config");
  }

  return { draw };
})();
