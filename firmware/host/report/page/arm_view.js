// SPDX-License-Identifier: Apache-2.0
// The 3-D view: the arm at the shared time, its paths, a slider and a play button.

Fovea.armView = (function () {
  const { el, clock, theme, suffix, sceneView } = Fovea;
  const make = Fovea.armScene;

  // The pose of a link between two frames of the scene.
  function poser(run, group) {
    const { t_s: times, poses } = run.scene;
    const count = group.children.length;
    const a = new THREE.Quaternion();
    const b = new THREE.Quaternion();
    return (t) => {
      const low = Math.min(Math.max(0, Fovea.indexAt(times, t)), times.length - 1);
      const high = Math.min(low + 1, times.length - 1);
      const part = high > low ? Math.min(1, Math.max(0, (t - times[low]) / (times[high] - times[low]))) : 0;
      for (let k = 0; k < count; k++) {
        const i = (low * count + k) * 7;
        const j = (high * count + k) * 7;
        group.children[k].position.set(...[0, 1, 2].map((c) => poses[i + c] + part * (poses[j + c] - poses[i + c])));
        a.set(poses[i + 4], poses[i + 5], poses[i + 6], poses[i + 3]);
        b.set(poses[j + 4], poses[j + 5], poses[j + 6], poses[j + 3]);
        group.children[k].quaternion.copy(a.slerp(b, part));
      }
    };
  }

  function pointAt(run, flat, t) {
    const i = Math.min(Math.max(0, Fovea.indexAt(run.scene.t_s, t)), flat.length / 3 - 1) * 3;
    const p = new THREE.Vector3(flat[i], flat[i + 1], flat[i + 2]);
    return Number.isFinite(p.x + p.y + p.z) ? p : null;
  }

  function turnAt(run, flat, t) {
    const i = Math.min(Math.max(0, Fovea.indexAt(run.scene.t_s, t)), flat.length / 4 - 1) * 4;
    return Number.isFinite(flat[i]) ? new THREE.Quaternion(flat[i + 1], flat[i + 2], flat[i + 3], flat[i]) : null;
  }

  // All objects of one run that move with the time.
  function actor(run, scene) {
    const ghost = run.index > 0;
    const arm = make.arm(run, ghost);
    const setPose = poser(run, arm);
    const group = new THREE.Group();
    group.add(arm);
    const parts = [];
    const own = (object, colour) => {
      object.userData.colour = colour;
      parts.push(object);
      group.add(object);
      return object;
    };
    const { camera_path: seen, target_path: target, target_turn: turns } = run.scene;
    if (seen) own(make.path(seen, "--blue", ghost, 0.005), "--blue");
    if (target) own(make.path(target, "--vermillion", ghost, 0.004), "--vermillion");
    const dot = seen
      ? own(new THREE.Mesh(new THREE.SphereBufferGeometry(0.013, 20, 14), new THREE.MeshBasicMaterial()), "--blue")
      : null;
    const thing = target ? make.target(run, ghost) : null;
    if (thing) group.add(thing);
    const gaze =
      dot && thing
        ? own(
            new THREE.Line(
              new THREE.BufferGeometry(),
              new THREE.LineDashedMaterial({ dashSize: 0.02, gapSize: 0.014 }),
            ),
            "--axis",
          )
        : null;
    scene.add(group);
    const set = (t) => {
      setPose(t);
      const from = dot && pointAt(run, seen, t);
      const to = thing && pointAt(run, target, t);
      if (from) dot.position.copy(from);
      if (to) thing.position.copy(to);
      const turn = thing && turns && turnAt(run, turns, t);
      if (turn) thing.quaternion.copy(turn);
      if (gaze && from && to) {
        gaze.geometry.setFromPoints([from, to]);
        gaze.computeLineDistances();
      }
    };
    return { run, group, parts, set };
  }

  function paint(object) {
    const colour = make.css(object.userData.colour);
    object.traverse((node) => {
      if (node.material) node.material.color.copy(colour);
    });
  }

  // The view with an actor for each run.
  function build(host, runs, canvas, gl) {
    const view = Fovea.sceneView.build(host, canvas, gl, {
      table_z: runs[0].scene.table_z,
      workspace_radius: runs[0].scene.workspace_radius,
      keep: true,
      paint: () => view.actors.forEach((a) => a.parts.forEach(paint)),
    });
    view.actors = runs.map((run) => actor(run, view.scene));
    view.setTime = (t) => {
      view.actors.forEach((a) => a.set(t));
      view.ask();
    };
    view.start();
    return view;
  }

  function legend(runs, view) {
    const item = (colour, words, dots) => el("li", {}, Fovea.swatch({ colour, dots }), el("span", { text: words }));
    const items = [item("--blue", runs.some((run) => run.has_eye) ? "path of the camera" : "path of the hand")];
    if (runs.some((run) => run.scene.target_path)) items.push(item("--vermillion", "path of the target", true));
    if (runs[0].scene.workspace_radius)
      items.push(item("--rim", `allowed workspace, a sphere of ${Fovea.number(runs[0].scene.workspace_radius, 3)} m`));
    const boxes =
      runs.length < 2
        ? []
        : view.actors.map((a) => {
            const box = el("input", {
              type: "checkbox",
              checked: true,
              onchange: () => {
                a.group.visible = box.checked;
                view.ask();
              },
            });
            return el(
              "li",
              {},
              el("label", {}, box, ` run${suffix(a.run)} (${a.run.index ? "pale, dashed path" : "solid"})`),
            );
          });
    return el("ul", { class: "legend plain" }, items, el("li", {}, el("span", { text: "grid squares: 10 cm" })), boxes);
  }

  function draw(runs) {
    const body = document.querySelector("#path .body");
    const shown = runs.filter((run) => run.scene && run.scene.poses && run.scene.t_s && run.scene.t_s.length);
    const missing = runs.filter((run) => !shown.includes(run));
    if (missing.length)
      body.append(
        Fovea.absent(
          `The log${runs.length > 1 ? ` of run ${missing.map((r) => r.letter).join(" and ")}` : ""} holds no scene to draw: no robot model or no poses.`,
        ),
      );
    if (!shown.length) return Fovea.drawn("path");
    const canvas = el("canvas", {
      tabindex: "0",
      role: "application",
      "aria-label":
        "The arm and the paths of camera and target in three dimensions. Arrow keys turn the view, plus and minus zoom.",
    });
    const gl = sceneView.context(canvas, true);
    if (!gl) {
      body.append(Fovea.absent("This browser offers no WebGL, so the path in space cannot be shown here."));
      return Fovea.drawn("path");
    }
    const still = el("img", { class: "print-image", alt: "The arm and the paths of camera and target" });
    const host = el("div", { class: "scene" }, canvas);
    body.append(host, still);
    const view = build(host, shown, canvas, gl);
    const controls = Fovea.player();
    body.append(
      el("div", { class: "toolbar under" }, controls.node, sceneView.steering(view, host, canvas)),
      legend(shown, view),
      el("p", {
        class: "hint no-print",
        text: "Drag to turn; drag with the right button to move. After a click the wheel zooms. All plots share this time.",
      }),
    );
    const follow = (t) => {
      view.setTime(t);
      controls.show(t);
    };
    follow(clock.time === null ? clock.duration : clock.time);
    clock.listen((what, source) => {
      if (what !== "time" || clock.time === null) return;
      if (source !== "player") controls.stop();
      follow(clock.time);
    });
    theme.listen(() => {
      view.colours();
      view.render();
      if (theme.printing) still.src = canvas.toDataURL("image/png");
    });
    view.render();
    Fovea.drawn("path");
  }

  return { draw };
})();
