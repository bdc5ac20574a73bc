// SPDX-License-Identifier: Apache-2.0
// Two runs side by side: the table of figures with their difference.

Fovea.compare = (function () {
  const { el, number } = Fovea;

  // Says which run is better, if the difference is clear.
  function better(a, b) {
    if (!a || !b || !a.better || a.value === b.value) return "";
    const scale = Math.max(Math.abs(a.value), Math.abs(b.value));
    if (!a.count && Math.abs(a.value - b.value) < (a.slack || 0.05) * scale) return "about equal";
    return a.value < b.value === (a.better === "low") ? "A is better" : "B is better";
  }

  function difference(a, b) {
    if (!a || !b) return "–";
    const delta = b.value - a.value;
    if (delta === 0) return "0";
    const text = a.count ? String(Math.abs(delta)) : number(Math.abs(delta), 2);
    return (delta > 0 ? "+" : "−") + text;
  }

  function row(label, unit, a, b) {
    const verdict = better(a, b);
    const cell = (figure, wins) => ({ class: wins ? "wins" : null, of: figure ? Fovea.verdict.show(figure) : "–" });
    return [
      [label, unit ? el("span", { class: "unit", text: ` [${unit}]` }) : null],
      cell(a, verdict.startsWith("A")),
      cell(b, verdict.startsWith("B")),
      [difference(a, b), el("span", { class: "better", text: verdict })],
    ];
  }

  function table(runs) {
    const [first, second] = runs.map((run) => new Map(Fovea.verdict.figures(run).map((f) => [f.key, f])));
    const keys = Array.from(new Set([...first.keys(), ...second.keys()]));
    const rows = keys.map((key) => {
      const one = first.get(key) || second.get(key);
      return row(one.label, one.unit, first.get(key), second.get(key));
    });
    for (const [key, label] of [
      ["p50", "Tick time, median"],
      ["p99", "Tick time, 99 %"],
      ["p999", "Tick time, 99.9 %"],
      ["max", "Tick time, longest"],
    ]) {
      const [a, b] = runs.map((run) => {
        const times = run.summary && run.summary.tick_ns;
        return times && Number.isFinite(times[key]) ? { value: times[key] / 1000, better: "low", slack: 0.15 } : null;
      });
      if (a || b) rows.push(row(label, "µs", a, b));
    }
    const heads = ["Figure", "A", "B", ["B − A", el("span", { class: "better" })]];
    return Fovea.table(heads, rows, { class: "figures", caption: "Figures of both runs", number: (i) => i > 0 });
  }

  // Lines of two texts as [{side: ' ' | 'A' | 'B', text}], by the longest common subsequence.
  function diff(textA, textB) {
    const a = textA.split("\n");
    const b = textB.split("\n");
    const length = a.map(() => new Uint16Array(b.length + 1));
    length.push(new Uint16Array(b.length + 1));
    for (let i = a.length - 1; i >= 0; i--) {
      for (let j = b.length - 1; j >= 0; j--) {
        length[i][j] = a[i] === b[j] ? length[i + 1][j + 1] + 1 : Math.max(length[i + 1][j], length[i][j + 1]);
      }
    }
    const lines = [];
    let i = 0;
    let j = 0;
    while (i < a.length || j < b.length) {
      if (i < a.length && j < b.length && a[i] === b[j]) {
        lines.push({ side: " ", text: a[i] });
        i++;
        j++;
      } else if (j >= b.length || (i < a.length && length[i + 1][j] >= length[i][j + 1]))
        lines.push({ side: "A", text: a[i++] });
      else lines.push({ side: "B", text: b[j++] });
    }
    return lines;
  }

  return { table, diff };
})();
