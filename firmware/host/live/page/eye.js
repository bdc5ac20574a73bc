// SPDX-License-Identifier: Apache-2.0
// The camera's picture at the shown moment, with the outlines of goal, detection and truth.
import { CPU_CANVAS } from "./canvas.js";

const { el } = Fovea;
const STYLES = {
  truth: { colour: "#ffffff", dash: [2, 3], width: 2 },
  detection: { colour: "#4fd8ff", dash: [], width: 2 },
  goal: { colour: "#ffd83d", dash: [8, 5], width: 2 },
};

export class Eye {
  #busy = false;
  #wanted = null;
  #shown = null;

  constructor(host, model, moment) {
    this.model = model;
    this.moment = moment;
    this.canvas = el("canvas", { width: 640, height: 480, role: "img", "aria-label": "What the camera sees" });
    this.caption = el("figcaption", {}, el("span", { text: "waiting for the first picture" }));
    const outlines = el("input", { type: "checkbox", id: "outlines", checked: true, onchange: () => this.#paint() });
    this.outlines = outlines;
    host.append(
      el("figure", { class: "picture" }, el("div", { class: "picture-frame" }, this.canvas), this.caption),
      el(
        "ul",
        { class: "legend plain" },
        Object.keys(Fovea.ROLES).map((role) => Fovea.roleItem(role, true)),
        el("li", {}, el("label", { for: "outlines" }, outlines, " show outlines")),
      ),
    );
    model.listen((what, detail) => {
      if (what === "picture" && moment.isLive) this.#want(detail);
      if (what === "outlines" && this.#shown && this.#shown.entry.t === detail) this.#paint();
      if (what === "reset") this.#shown = null;
    });
    moment.listen(() => this.#want(moment.isLive ? model.pictures.last : model.pictures.at(moment.t)));
  }

  // Decodes one picture at a time; of those that come meanwhile the newest is next.
  async #want(entry) {
    if (!entry) return;
    this.#wanted = entry;
    if (this.#busy) return;
    this.#busy = true;
    while (this.#wanted) {
      const next = this.#wanted;
      this.#wanted = null;
      try {
        const bitmap = await createImageBitmap(new Blob([next.jpeg], { type: "image/jpeg" }));
        if (this.#shown) this.#shown.bitmap.close();
        this.#shown = { entry: next, bitmap };
        this.#paint();
        this.canvas.dataset.pictures = Number(this.canvas.dataset.pictures || 0) + 1;
      } catch (trouble) {
        this.caption.firstChild.textContent = `A picture could not be read: ${trouble.message}`;
      }
    }
    this.#busy = false;
  }

  #paint() {
    if (!this.#shown) return;
    const { bitmap, entry } = this.#shown;
    const { canvas } = this;
    if (canvas.width !== bitmap.width) [canvas.width, canvas.height] = [bitmap.width, bitmap.height];
    const ctx = canvas.getContext("2d", CPU_CANVAS);
    ctx.drawImage(bitmap, 0, 0);
    if (this.outlines.checked)
      for (const role of Object.keys(STYLES))
        for (const shape of entry.outlines || []) if (shape.role === role) outline(ctx, shape.points, role);
    const found = (entry.outlines || []).some(({ role }) => role === "detection");
    const words = `at ${entry.t.toFixed(2)} s${entry.outlines && !found ? ", target not found" : ""}`;
    this.caption.firstChild.textContent = words;
  }
}

function outline(ctx, points, role) {
  if (!points.length) return;
  const { colour, dash, width } = STYLES[role];
  const path = new Path2D();
  points.forEach(({ x, y }, i) => (i ? path.lineTo(x, y) : path.moveTo(x, y)));
  path.closePath();
  stroke(ctx, path, colour, dash, width);
  if (role !== "goal") return;
  const x = points.reduce((sum, p) => sum + p.x, 0) / points.length;
  const y = points.reduce((sum, p) => sum + p.y, 0) / points.length;
  stroke(ctx, new Path2D(`M${x - 9} ${y}h18M${x} ${y - 9}v18`), colour, [], 1.5);
}

// A line with a dark rim, so that it is seen on any picture.
function stroke(ctx, path, colour, dash, width) {
  ctx.save();
  ctx.lineWidth = width + 2;
  ctx.globalAlpha = 0.45;
  ctx.strokeStyle = "#000000";
  ctx.stroke(path);
  ctx.globalAlpha = 1;
  ctx.lineWidth = width;
  ctx.strokeStyle = colour;
  ctx.setLineDash(dash);
  ctx.stroke(path);
  ctx.restore();
}
