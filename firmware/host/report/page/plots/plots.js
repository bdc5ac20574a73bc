// SPDX-License-Identifier: Apache-2.0
// One kind of time plot, drawn by Dygraphs, with a legend that shows the values at the shared time.

Fovea.plots = (function () {
  const { el, clock, theme, number, swatch, dashOf } = Fovea;

  // Rows for Dygraphs: null where a series has no sample (bridged), NaN where it has no value (a gap).
  function rowsOf(series) {
    const times = Array.from(new Set(series.map((s) => s.t)));
    const next = times.map(() => 0);
    const rows = [];
    for (;;) {
      let t = Infinity;
      times.forEach((list, k) => {
        if (next[k] < list.length && list[next[k]] < t) t = list[next[k]];
      });
      if (t === Infinity) return rows;
      const row = [t];
      const here = times.map((list, k) => (list[next[k]] === t ? next[k]++ : -1));
      for (const s of series) {
        const at = here[times.indexOf(s.t)];
        row.push(at < 0 ? null : s.v[at]);
      }
      rows.push(row);
    }
  }

  function drawDot(hollow) {
    return (g, name, ctx, x, y, colour, radius) => {
      ctx.beginPath();
      ctx.arc(x, y, hollow ? radius + 0.4 : radius, 0, 2 * Math.PI);
      if (hollow) {
        ctx.lineWidth = 1;
        ctx.strokeStyle = colour;
        ctx.stroke();
      } else {
        ctx.fillStyle = colour;
        ctx.fill();
      }
    };
  }

  const axisText = (value) => String(parseFloat(value.toPrecision(6))).replace("-", "−");

  // Labels of a logarithmic axis: the decades, and 2 and 5 of each when there are few.
  function decades(low, high) {
    const ticks = [];
    if (!(low > 0 && high > low)) return ticks;
    const steps = Math.log10(high / low) < 2.2 ? [1, 2, 5] : [1];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
      for (const step of steps) {
        const v = step * Math.pow(10, power);
        if (v >= low * 0.999 && v <= high) ticks.push({ v, label: axisText(v) });
      }
    }
    return ticks;
  }

  // options: {label, summary, series, log, range, includeZero, lines, endLabels, format, height}
  function create(host, options) {
    const state = Object.assign({ format: (v) => number(v, 3), lines: [] }, options);
    const area = el("div", { class: "plot-area", style: state.height ? `height:${state.height}px` : null });
    const cursor = el("div", { class: "cursor", hidden: true });
    const brush = el("div", { class: "brush", hidden: true });
    const glass = el("div", { class: "glass" }, cursor, brush);
    const ends = el("div", { "aria-hidden": "true" });
    const still = el("img", { class: "plot-still", alt: "" });
    const frame = el(
      "div",
      {
        class: "plot-frame",
        tabindex: "0",
        role: "group",
        onkeydown: Fovea.timeKeys,
        "aria-label": `Plot: ${state.summary || state.label}. Arrow keys move the time, plus and minus zoom, Escape shows everything.`,
      },
      area,
      still,
      ends,
      glass,
    );
    const now = el("span", { class: "now" });
    const legend = el("ul", { class: "legend" });
    const caption = el("figcaption", {}, el("span", { class: "plot-label", text: state.label }), now);
    const figure = el(
      "figure",
      { class: "plot" },
      caption,
      frame,
      el("p", { class: "axis-x", text: "time [s]" }),
      legend,
    );
    host.append(figure);
    let graph = null;
    let outputs = [];
    let visible = [];

    function fillLegend() {
      legend.textContent = "";
      visible = state.series.map(() => true);
      // One entry for each quantity; it covers the lines of both runs.
      outputs = Array.from(new Set(state.series.map((s) => s.name))).map((name) => {
        const members = state.series.map((s, i) => i).filter((i) => state.series[i].name === name);
        const output = el("span", { class: "legend-value" });
        const button = el(
          "button",
          { type: "button", "aria-pressed": "true", title: "show or hide" },
          swatch(...members.map((i) => state.series[i])),
          el("span", { text: name }),
          output,
        );
        button.addEventListener("click", () => {
          const on = !visible[members[0]];
          members.forEach((i) => {
            visible[i] = on;
          });
          button.setAttribute("aria-pressed", String(on));
          graph.setVisibility(members, on);
        });
        legend.append(el("li", {}, button));
        return { output, members };
      });
      if (state.series.some((s) => s.run))
        legend.append(
          el("li", {
            class: "rule",
            text: state.series.every((s) => s.dots)
              ? "A filled, B hollow"
              : state.series.some((s) => s.dots)
                ? "A solid or filled, B dashed or hollow"
                : "A solid, B dashed",
          }),
        );
    }

    function styles() {
      const series = {};
      state.series.forEach((s, i) => {
        series[`s${i}`] = {
          color: theme.colour(s.colour),
          strokeWidth: s.dots ? 0 : s.width || 1.6,
          strokePattern: dashOf(s),
          drawPoints: !!s.dots,
          pointSize: s.dots ? s.size || 1.9 : 1,
          drawPointCallback: drawDot(!!s.run),
        };
      });
      const grid = theme.colour("--grid");
      const y = {
        gridLineColor: grid,
        gridLineWidth: 1,
        axisLabelFormatter: axisText,
        axisLabelWidth: 46,
        pixelsPerLabel: 32,
      };
      if (state.log) y.ticker = decades;
      return {
        series,
        axisLineColor: theme.colour("--axis"),
        axes: {
          x: { gridLineColor: grid, gridLineWidth: 1, axisLabelFormatter: axisText, pixelsPerLabel: 60 },
          y,
        },
      };
    }

    // The shading of the run, and lines across the plot, such as limits.
    function underlay(ctx, box, g) {
      Fovea.bands.paint(ctx, box, (t) => g.toDomXCoord(t));
      for (const line of state.lines) {
        const y = Math.round(g.toDomYCoord(line.value));
        if (!(y >= box.y - 1 && y <= box.y + box.h + 1)) continue;
        ctx.save();
        ctx.strokeStyle = ctx.fillStyle = theme.colour(line.colour || "--alarm");
        ctx.globalAlpha = line.alpha || 1;
        ctx.setLineDash(line.dash || [2, 3]);
        ctx.lineWidth = 2;
        ctx.beginPath();
        ctx.moveTo(box.x, y);
        ctx.lineTo(box.x + box.w, y);
        ctx.stroke();
        if (line.text) {
          ctx.font = "11px system-ui, sans-serif";
          ctx.textAlign = "left";
          ctx.fillText(line.text, box.x + 5, line.above ? y - 4 : y + 12);
        }
        ctx.restore();
      }
    }

    function place() {
      const box = graph.getArea();
      Object.assign(glass.style, { left: `${box.x}px`, top: `${box.y}px`, width: `${box.w}px`, height: `${box.h}px` });
      if (state.endLabels) Fovea.plots.endLabels(ends, box, graph, state.series, visible);
      moveCursor();
    }

    function moveCursor() {
      const shown = clock.time !== null && clock.time >= clock.span[0] && clock.time <= clock.span[1];
      cursor.hidden = !shown;
      now.textContent = clock.time === null ? "" : `at ${clock.time.toFixed(3)} s`;
      if (shown && graph) cursor.style.left = `${graph.toDomXCoord(clock.time) - graph.getArea().x}px`;
      const reach = clock.duration / 60;
      for (const { output, members } of outputs) {
        const value = (s) =>
          (Fovea.runs.length > 1 ? Fovea.runs[s.run].letter + " " : "") +
          state.format(Fovea.valueAt(s.t, s.v, clock.time, reach));
        output.textContent = clock.time === null ? "" : members.map((i) => value(state.series[i])).join(" · ");
      }
    }

    // A canvas painted during `beforeprint` is not printed, but an image of it is.
    function keepStill() {
      const layers = Array.from(area.querySelectorAll("canvas"));
      const copy = el("canvas", { width: layers[0].width, height: layers[0].height });
      layers.forEach((layer) => copy.getContext("2d").drawImage(layer, 0, 0));
      still.src = copy.toDataURL();
      still.style.width = layers[0].style.width;
      still.style.height = layers[0].style.height;
    }

    function build() {
      fillLegend();
      const labels = ["time", ...state.series.map((s, i) => `s${i}`)];
      const base = {
        labels,
        legend: "never",
        connectSeparatedPoints: true,
        highlightCircleSize: 0,
        showLabelsOnHighlight: false,
        interactionModel: {},
        dateWindow: clock.span.slice(),
        valueRange: state.range || null,
        logscale: !!state.log,
        xAxisHeight: 18,
        includeZero: !!state.includeZero,
        rightGap: state.endLabels ? 22 : 10,
        underlayCallback: underlay,
        drawCallback: () => {
          if (graph) place();
        },
        visibility: visible.slice(),
      };
      if (graph) graph.destroy();
      graph = null;
      graph = new Dygraph(area, rowsOf(state.series), Object.assign(base, styles()));
      place();
    }

    build();
    Fovea.pointer(glass, brush, (x) => graph.toDataXCoord(x + graph.getArea().x));
    const watch = new ResizeObserver(() => {
      if (!theme.printing && area.clientWidth) graph.resize();
    });
    watch.observe(area);
    const endings = [
      () => watch.disconnect(),
      clock.listen((what) => {
        if (what === "span") graph.updateOptions({ dateWindow: clock.span.slice() });
        moveCursor();
      }),
      theme.listen(() => {
        graph.updateOptions(styles(), true);
        graph.resize();
        graph.updateOptions({});
        if (theme.printing) keepStill();
      }),
    ];
    return {
      remove() {
        endings.forEach((end) => end());
        graph.destroy();
        figure.remove();
      },
      change(more) {
        Object.assign(state, more);
        if (more.label) caption.firstChild.textContent = more.label;
        build();
      },
    };
  }

  return { create };
})();

// Numbers at the right ends of lines, pushed apart so that they do not cover each other.
Fovea.plots.endLabels = function (host, box, g, series, visible) {
  const labels = [];
  series.forEach((s, i) => {
    const at = Fovea.indexAt(s.t, Fovea.clock.span[1]);
    if (visible[i] && s.tag && at >= 0 && Number.isFinite(s.v[at])) labels.push({ y: g.toDomYCoord(s.v[at]), s });
  });
  labels.sort((a, b) => a.y - b.y);
  for (let pass = 0; pass < 40; pass++) {
    for (let i = 1; i < labels.length; i++) {
      const overlap = 11 - (labels[i].y - labels[i - 1].y);
      if (overlap > 0) {
        labels[i].y += overlap / 2;
        labels[i - 1].y -= overlap / 2;
      }
    }
  }
  host.textContent = "";
  for (const { y, s } of labels) {
    host.append(
      Fovea.el("span", {
        class: "end-label",
        text: s.tag,
        style: `left:${box.x + box.w + 5}px;top:${y}px;border-color:var(${s.colour})`,
      }),
    );
  }
};
