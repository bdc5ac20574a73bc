// SPDX-License-Identifier: Apache-2.0
// The background of every plot over time: the servo's modes as faint shading, injected faults as labelled bands.

Fovea.bands = (function () {
  const { el, svg, clock, theme, words, MODES } = Fovea;

  const endOf = (run) => (Number.isFinite(run.duration_s) ? run.duration_s : clock.duration);

  function modesOf(run) {
    return run.modes.map((m, i) => ({
      from: m.t_s,
      to: i + 1 < run.modes.length ? run.modes[i + 1].t_s : endOf(run),
      mode: String(m.mode).toLowerCase(),
      reason: m.reason,
    }));
  }

  // Faults that were injected into the run. A fault that never ends has no end in the summary, or a very late one.
  function injectedOf(run) {
    const list = run.summary && Array.isArray(run.summary.injected) ? run.summary.injected : [];
    return list
      .filter((f) => Number.isFinite(f.from_s) && f.from_s <= endOf(run))
      .map((f) => ({
        from: Math.max(0, f.from_s),
        to: Number.isFinite(f.to_s) ? Math.min(f.to_s, endOf(run)) : endOf(run),
        name: words(f.name),
        noticed: f.noticed && typeof f.noticed === "object" ? f.noticed : {},
      }));
  }

  function hatch(ctx, left, top, width, height) {
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.beginPath();
    for (let x = left - height; x < left + width; x += 9) {
      ctx.moveTo(x, top + height);
      ctx.lineTo(x + height, top);
    }
    ctx.globalAlpha = 0.4;
    ctx.lineWidth = 1;
    ctx.stroke();
  }

  // Paints into `box`, behind the curves. With two runs, A has the upper half and B the lower one.
  function paint(ctx, box, xOf) {
    const runs = Fovea.runs;
    const height = box.h / runs.length;
    ctx.save();
    ctx.beginPath();
    ctx.rect(box.x, box.y, box.w, box.h);
    ctx.clip();
    runs.forEach((run, k) => {
      const top = box.y + k * height;
      const at = (t) => Math.min(box.x + box.w, Math.max(box.x, xOf(t)));
      for (const { from, to, mode } of modesOf(run)) {
        ctx.globalAlpha = mode === "fault" ? 0.12 : 0.2;
        ctx.fillStyle = theme.colour(MODES[mode] ? MODES[mode].colour : "--axis");
        ctx.fillRect(at(from), top, at(to) - at(from), height);
      }
      injectedOf(run).forEach((fault, row) => {
        if (xOf(fault.to) < box.x || xOf(fault.from) > box.x + box.w) return;
        paintInjected(ctx, fault, at(fault.from), at(fault.to), { x: box.x, w: box.w, top, height }, row);
      });
    });
    ctx.restore();
  }

  function paintInjected(ctx, fault, left, right, lane, row) {
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = theme.colour("--alarm");
    ctx.globalAlpha = 0.1;
    ctx.fillRect(left, lane.top, Math.max(1.5, right - left), lane.height);
    ctx.save();
    hatch(ctx, left, lane.top, Math.max(1.5, right - left), lane.height);
    ctx.restore();
    ctx.globalAlpha = 0.9;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    for (const x of [left, right]) {
      ctx.moveTo(x, lane.top);
      ctx.lineTo(x, lane.top + lane.height);
    }
    ctx.stroke();
    ctx.globalAlpha = 1;
    ctx.font = "600 11px system-ui, sans-serif";
    const text = `injected: ${fault.name}`;
    const x = Math.max(lane.x + 3, Math.min(left + 4, lane.x + lane.w - ctx.measureText(text).width - 3));
    const y = lane.top + 12 + 13 * row;
    ctx.lineWidth = 4;
    ctx.lineJoin = "round";
    ctx.strokeStyle = theme.colour("--card");
    ctx.strokeText(text, x, y);
    ctx.fillText(text, x, y);
    ctx.restore();
  }

  // The legend of the shading, for above or below the plots of a part.
  function legend(runs) {
    const shown = runs.flatMap(modesOf).map((m) => m.mode);
    const entry = (name, more, text) =>
      el(
        "li",
        {},
        svg(
          "svg",
          { viewBox: "0 0 22 12", "aria-hidden": "true" },
          svg("g", { class: `span ${name}` }, svg("rect", { width: 22, height: 12, rx: 2 }), more),
        ),
        el("span", { text }),
      );
    const items = Object.keys(MODES)
      .filter((mode) => shown.includes(mode))
      .map((mode) => entry(mode, null, `${mode}: ${MODES[mode].words}`));
    if (runs.some((run) => injectedOf(run).length))
      items.push(
        entry(
          "injected",
          svg("path", { d: "M0 12L12 0M7 12L19 0M14 12L26 0" }),
          "injected fault: put into the run on purpose",
        ),
      );
    if (!items.length) return null;
    const words = runs.length > 1 ? "Shading, A above, B below:" : "Shading:";
    return el("ul", { class: "mode-legend" }, el("li", { class: "mode-legend-head", text: words }), items);
  }

  return { modesOf, injectedOf, paint, legend };
})();
