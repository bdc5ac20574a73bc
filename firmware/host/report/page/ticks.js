// SPDX-License-Identifier: Apache-2.0
// How long a servo tick takes: a histogram with a logarithmic axis, its percentiles, and the budget of 1 ms.

Fovea.ticks = (function () {
  const { el, svg, number, suffix } = Fovea;
  const BUDGET_US = 1000;
  const MARKS = [
    ["p50", "p50"],
    ["p99", "p99"],
    ["p999", "p99.9"],
    ["max", "max"],
  ];

  const isLockstep = (run) => !!run.summary && run.summary.pace === "lockstep";

  // Explains a longest tick above the budget; null when there is none.
  function longestWords(run) {
    const longest = percentiles(run).find((mark) => mark.name.endsWith("max"));
    if (!longest || longest.us <= BUDGET_US) return null;
    const what = `${suffix(run) ? `Run${suffix(run)}: the` : "The"} longest tick took ${number(longest.us, 4)} µs, above the budget of 1 ms.`;
    return isLockstep(run)
      ? {
          text: `${what} In lockstep the simulated clock waits for the servo: no tick can overrun, however long this computer takes for it.`,
          alarm: false,
        }
      : { text: `${what} The clock did not wait: the next tick began late.`, alarm: true };
  }

  const usable = (run) =>
    run.tick_times && Array.isArray(run.tick_times.counts) && run.tick_times.counts.some((c) => c > 0);

  // The percentiles [µs] from the summary, else from the histogram (upper edges of its buckets).
  function percentiles(run) {
    const given = run.summary && run.summary.tick_ns;
    if (given)
      return MARKS.map(([key, name]) => ({ name, us: given[key] / 1000 })).filter((m) => Number.isFinite(m.us));
    const { upper_us: upper, counts } = run.tick_times;
    const total = counts.reduce((a, b) => a + b, 0);
    return [0.5, 0.99, 0.999, 1]
      .map((part, k) => {
        let sum = 0;
        const at = counts.findIndex((c) => (sum += c) >= part * total);
        return { name: "≤ " + MARKS[k][1], us: upper[at] };
      })
      .filter((m) => Number.isFinite(m.us));
  }

  function bounds(runs) {
    let low = Infinity;
    let high = BUDGET_US * 1.6;
    let most = 1;
    for (const run of runs) {
      const { upper_us: upper, counts } = run.tick_times;
      counts.forEach((count, i) => {
        if (!count) return;
        low = Math.min(low, i ? upper[i - 1] : upper[i] / 1.3);
        high = Math.max(high, Number.isFinite(upper[i]) ? upper[i] : high);
        most = Math.max(most, count);
      });
      percentiles(run).forEach((m) => {
        high = Math.max(high, m.us * 1.3);
      });
    }
    return { low: Math.max(low, 1e-3), high, most };
  }

  function paint(drawing, runs, width) {
    const { low, high, most } = bounds(runs);
    const top = 22 + runs.length * 4 * 15;
    const height = 230 + top;
    const left = 52;
    const right = 14;
    const bottom = height - 24;
    const span = Math.log10(high / low);
    const x = (us) => left + (Math.log10(Math.max(us, low) / low) / span) * (width - left - right);
    const y = (count) =>
      count < 0.7 ? bottom : bottom - (Math.log10(count / 0.7) / Math.log10((most * 1.3) / 0.7)) * (bottom - top);
    drawing.textContent = "";
    drawing.setAttribute("viewBox", `0 0 ${width} ${height}`);
    drawing.setAttribute("height", height);
    const line = (x1, y1, x2, y2, name) => drawing.append(svg("line", { x1, y1, x2, y2, class: name }));
    const text = (at, down, words, name, anchor) =>
      drawing.append(svg("text", { x: at, y: down, class: name, "text-anchor": anchor, text: words }));
    for (let power = Math.ceil(Math.log10(low)); power <= Math.log10(high); power++) {
      const at = x(Math.pow(10, power));
      line(at, top, at, bottom, "grid");
      text(at, bottom + 16, String(Math.pow(10, power)), "tick", "middle");
    }
    for (let count = 1; count <= most * 1.3; count *= 10) {
      line(left, y(count), width - right, y(count), "grid");
      text(left - 6, y(count) + 4, String(count), "tick", "end");
    }
    line(left, bottom, width - right, bottom, "axis");
    runs.forEach((run) => paintCounts(drawing, run, x, y, bottom, low));
    const budget = x(BUDGET_US);
    line(budget, 8, budget, bottom, "budget");
    text(budget - 5, 17, "budget 1 ms", "budget-text", "end");
    runs.forEach((run) =>
      percentiles(run).forEach((mark, k) => {
        const at = x(mark.us);
        const down = 32 + (run.index * 4 + k) * 15;
        line(at, down - 4, at, bottom, `percentile run-${run.index}`);
        const flip = at + 88 > width;
        text(
          flip ? at - 4 : at + 4,
          down,
          `${mark.name}${suffix(run)} ${number(mark.us, 3)} µs`,
          !isLockstep(run) && mark.us > BUDGET_US ? "mark-text over" : "mark-text",
          flip ? "end" : "start",
        );
      }),
    );
  }

  function paintCounts(drawing, run, x, y, bottom, low) {
    const { upper_us: upper, counts } = run.tick_times;
    if (run.index === 0) {
      const bars = svg("g", { class: "bars" });
      counts.forEach((count, i) => {
        const from = x(i ? upper[i - 1] : low);
        if (count > 0)
          bars.append(
            svg(
              "rect",
              { x: from, y: y(count), width: Math.max(0.8, x(upper[i]) - from - 0.6), height: bottom - y(count) },
              svg("title", {
                text: `${number(i ? upper[i - 1] : 0)} to ${number(upper[i])} µs: ${Fovea.plural(count, "tick")}`,
              }),
            ),
          );
      });
      drawing.append(bars);
      return;
    }
    let path = `M${x(low)} ${bottom}`;
    counts.forEach((count, i) => {
      path += `L${x(i ? upper[i - 1] : low)} ${y(count)}H${x(upper[i])}`;
    });
    drawing.append(svg("path", { d: path, class: "steps" }));
  }

  function draw(runs) {
    const body = document.querySelector("#ticks .body");
    const shown = runs.filter(usable);
    if (!shown.length) {
      body.append(Fovea.absent("The log holds no tick times."));
      return Fovea.drawn("ticks");
    }
    const say = shown
      .map(
        (run) =>
          `${suffix(run) ? "run" + suffix(run) + " " : ""}${percentiles(run)
            .map((m) => `${m.name} ${number(m.us)} µs`)
            .join(", ")}`,
      )
      .join("; ");
    const drawing = svg("svg", {
      class: "histogram",
      role: "img",
      "aria-label": `Histogram of tick times: ${say}; the budget is 1000 µs`,
    });
    const frame = el("div", {}, drawing);
    body.append(
      el(
        "figure",
        { class: "plot" },
        el("figcaption", {}, el("span", { class: "plot-label", text: "ticks [count, logarithmic]" })),
        frame,
        el("p", { class: "axis-x", text: "time of a tick [µs, logarithmic]" }),
        shown.length > 1
          ? el("p", {
              class: "hint",
              text: "Filled bars and solid marks: run A. Stepped dashed outline and dashed marks: run B.",
            })
          : null,
      ),
    );
    for (const words of shown.map(longestWords).filter(Boolean))
      body.append(el("p", { class: words.alarm ? "hint over" : "hint", text: words.text }));
    const missing = runs.filter((run) => !usable(run));
    if (missing.length) body.append(Fovea.absent(`Run ${missing[0].letter} holds no tick times.`));
    const repaint = () => paint(drawing, shown, Math.max(240, frame.clientWidth));
    repaint();
    Fovea.theme.listen(repaint);
    addEventListener("resize", repaint);
    Fovea.drawn("ticks");
  }

  return { draw, isLockstep };
})();
