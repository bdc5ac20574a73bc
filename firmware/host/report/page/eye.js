// SPDX-License-Identifier: Apache-2.0
// The camera's pictures: the film, and the first and the last picture with outlines.

Fovea.eye = (function () {
  const { el, svg, fixed, ROLES } = Fovea;

  function outline(shape) {
    const points = (shape.points || []).filter((p) => p.every(Number.isFinite));
    if (!points.length) return null;
    const path = "M" + points.map((p) => `${p[0].toFixed(1)} ${p[1].toFixed(1)}`).join("L") + "Z";
    const group = svg(
      "g",
      { class: `outline ${ROLES[shape.role] ? shape.role : "other"}` },
      svg("path", { d: path, class: "halo" }),
      svg("path", { d: path }),
    );
    if (shape.role === "goal") {
      const middle = [0, 1].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
      const cross = `M${middle[0] - 9} ${middle[1]}h18M${middle[0]} ${middle[1] - 9}v18`;
      group.append(svg("path", { d: cross, class: "halo solid" }), svg("path", { d: cross, class: "solid" }));
    }
    return group;
  }

  function picture(run, which, frame) {
    const words = which === "first" ? "First picture" : "Last picture";
    const caption = el("figcaption", {
      text: `${words}${Fovea.suffix(run) && " of run" + Fovea.suffix(run)}, at ${fixed(frame.t_s, 3)} s`,
    });
    const shapes = frame.shapes || [];
    const roles = shapes.map((s) => s.role).join(", ");
    const image = el("img", {
      src: "data:image/jpeg;base64," + frame.jpeg,
      width: frame.width_px,
      height: frame.height_px,
      alt: `${words} of the camera${roles ? `, with outlines: ${roles}` : ""}`,
    });
    const order = ["truth", "detection", "goal"];
    const sorted = shapes.slice().sort((a, b) => order.indexOf(a.role) - order.indexOf(b.role));
    const overlay = svg(
      "svg",
      { viewBox: `0 0 ${frame.width_px} ${frame.height_px}`, class: "overlay", "aria-hidden": "true" },
      sorted.map(outline),
    );
    return el("figure", { class: "picture" }, el("div", { class: "picture-frame" }, image, overlay), caption);
  }

  function film(run) {
    const caption = el("figcaption", { text: `Film of the camera${Fovea.suffix(run) && ", run" + Fovea.suffix(run)}` });
    const figure = el("figure", { class: "picture film" });
    if (!run.video) {
      figure.append(Fovea.absent("There is no film of this run."));
      return figure;
    }
    const url = URL.createObjectURL(new Blob([Fovea.bytes(run.video)], { type: "video/mp4" }));
    const video = el("video", {
      src: url,
      controls: true,
      playsinline: true,
      preload: "auto",
      "aria-label": "Film of what the camera saw during the run",
    });
    video.muted = true;
    video.addEventListener("error", () => {
      video.replaceWith(Fovea.absent("This browser cannot play the film (H.264 in MP4)."));
    });
    link(run, video);
    figure.append(el("div", { class: "picture-frame" }, video), caption);
    return figure;
  }

  // A film as long as the run follows the shared time. While it plays, it sets the shared time.
  function link(run, video) {
    const clock = Fovea.clock;
    const follows = () =>
      Number.isFinite(video.duration) && Math.abs(video.duration - run.duration_s) < 0.1 * run.duration_s + 0.1;
    let wanted = null;
    video.addEventListener("timeupdate", () => {
      if (!video.paused && follows()) clock.setTime(video.currentTime, "film");
    });
    video.addEventListener("seeked", () => {
      if (wanted !== null) {
        const t = wanted;
        wanted = null;
        video.currentTime = t;
      }
    });
    clock.listen((what, source) => {
      if (what !== "time" || source === "film" || clock.time === null || !video.paused || !follows()) return;
      const t = Math.min(clock.time, video.duration - 0.01);
      if (video.seeking) wanted = t;
      else video.currentTime = t;
    });
  }

  function legend(runs) {
    const present = new Set(
      runs
        .flatMap((run) => Object.values(run.frames || {}))
        .filter(Boolean)
        .flatMap((frame) => (frame.shapes || []).map((s) => s.role)),
    );
    const items = Object.keys(ROLES)
      .filter((role) => present.has(role))
      .map((role) => Fovea.roleItem(role));
    if (!items.length) return null;
    const box = el("input", { type: "checkbox", id: "outlines", checked: true });
    box.addEventListener("change", () => document.getElementById("eye").classList.toggle("bare", !box.checked));
    return el(
      "ul",
      { class: "legend plain" },
      items,
      el("li", { class: "no-print" }, el("label", { for: "outlines" }, box, " show outlines")),
    );
  }

  function draw(runs) {
    const body = document.querySelector("#eye .body");
    const empty = (run) => !run.video && !(run.frames && (run.frames.first || run.frames.last));
    const host = runs.length > 1 ? el("div", { class: "columns" }) : body;
    if (host !== body) body.append(host);
    for (const run of runs) {
      if (empty(run)) continue;
      const frames = run.frames || {};
      const cells = [film(run)];
      for (const which of ["first", "last"])
        if (frames[which] && frames[which].jpeg) cells.push(picture(run, which, frames[which]));
      host.append(el("div", { class: runs.length > 1 ? "pictures paired" : "pictures" }, cells));
    }
    const without = runs.filter(empty);
    if (without.length)
      body.append(
        Fovea.absent(
          `The log${runs.length > 1 ? " of run " + without.map((r) => r.letter).join(" and ") : ""} holds no pictures of the camera.`,
        ),
      );
    const key = legend(runs);
    if (key) body.append(key);
    Fovea.drawn("eye");
  }

  return { draw };
})();
