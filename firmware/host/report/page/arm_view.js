// SPDX-License-Identifier: Apache-2.0
// The 3-D view: the arm at the shared time, its paths, a slider and a play button.

Fovea.armView = (function () {
  const { el, clock, theme, suffix } = Fovea;
  const make = Fovea.armScene;

  function context(canvas) {
    const wishes = { antialias: true, alpha: false, preserveDrawingBuffer: true };
    try {
      return canvas.getContext("webgl", wishes);
    } catch (trouble) {
      return null;
    }
  }

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

  function build(host, runs, canvas, gl) {
    const renderer = new THREE.WebGLRenderer({ canvas, context: gl, antialias: true, preserveDrawingBuffer: true });
    renderer.gammaOutput = true;
    renderer.gammaFactor = 2.2;
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    const scene = new THREE.Scene();
    make.lights(scene);
    const first = runs[0].scene;
    const floor = Number.isFinite(first.table_z) ? first.table_z : 0;
    const table = make.table(floor);
    scene.add(table);
    const radius = first.workspace_radius;
    const sphere = radius ? make.workspace(radius) : null;
    const circle =
      radius && radius > Math.abs(floor) ? make.ring(Math.sqrt(radius * radius - floor * floor), floor + 0.001) : null;
    if (sphere) scene.add(sphere);
    if (circle) scene.add(circle);
    const axes = make.axes(floor + 0.002);
    scene.add(axes.lines, ...axes.letters);
    const actors = runs.map((run) => actor(run, scene));

    const camera = new THREE.PerspectiveCamera(32, 1, 0.02, 30);
    camera.up.set(0, 0, 1);
    const controls = new THREE.OrbitControls(camera, canvas);
    Object.assign(controls, {
      enableKeys: false,
      enableZoom: false,
      maxPolarAngle: Math.PI * 0.62,
      minDistance: 0.3,
      maxDistance: 8,
    });
    let asked = false;
    const render = () => {
      asked = false;
      renderer.render(scene, camera);
    };
    const ask = () => {
      if (!asked) {
        asked = true;
        requestAnimationFrame(render);
      }
    };
    const home = () => {
      const top = radius || 0.85;
      controls.target.set(0.08, 0, (floor + top * 0.92) / 2);
      const away = 2.4 * Math.max(1, 0.5 + 0.62 / camera.aspect) * Math.max(0.5, top / 0.85);
      camera.position.copy(controls.target).add(new THREE.Vector3(0.62, -0.7, 0.3).normalize().multiplyScalar(away));
      controls.update();
      ask();
    };
    const colours = () => {
      renderer.setClearColor(new THREE.Color(theme.colour("--scene")));
      table.userData.grid.material.color.copy(make.css("--grid-3d"));
      if (sphere) sphere.material.uniforms.colour.value.set(theme.colour("--rim"));
      if (circle) circle.material.color.copy(make.css("--rim"));
      axes.lines.material.color.copy(make.css("--quiet"));
      axes.letters.forEach((s) => s.userData.paint(theme.colour("--quiet")));
      actors.forEach((a) => a.parts.forEach(paint));
    };
    const resize = () => {
      const width = host.clientWidth;
      const height = host.clientHeight;
      if (!width || !height) return;
      renderer.setPixelRatio(Math.min(2, devicePixelRatio || 1));
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
    };
    const setTime = (t) => {
      actors.forEach((a) => a.set(t));
      ask();
    };
    controls.addEventListener("change", ask);
    resize();
    colours();
    home();
    new ResizeObserver(() => {
      resize();
      render();
    }).observe(host);
    return { controls, camera, actors, render, ask, home, colours, resize, setTime };
  }

  // Turns the view [rad] and zooms it by a factor, for keys and buttons.
  function nudge(view, around, up, factor) {
    const offset = view.camera.position.clone().sub(view.controls.target);
    const place = new THREE.Spherical().setFromVector3(new THREE.Vector3(offset.x, offset.z, -offset.y));
    place.theta += around;
    place.phi = Math.min(view.controls.maxPolarAngle, Math.max(0.05, place.phi - up));
    place.radius = Math.min(8, Math.max(0.3, place.radius * factor));
    const v = new THREE.Vector3().setFromSpherical(place);
    view.camera.position.copy(view.controls.target).add(new THREE.Vector3(v.x, -v.z, v.y));
    view.controls.update();
    view.ask();
  }

  function steering(view, host, canvas) {
    canvas.addEventListener("keydown", (event) => {
      const moves = {
        ArrowLeft: [-0.1, 0, 1],
        ArrowRight: [0.1, 0, 1],
        ArrowUp: [0, 0.1, 1],
        ArrowDown: [0, -0.1, 1],
        "+": [0, 0, 0.85],
        "=": [0, 0, 0.85],
        "-": [0, 0, 1.18],
      };
      if (!moves[event.key]) return;
      nudge(view, ...moves[event.key]);
      event.preventDefault();
    });
    // A finger scrolls the page until turning is switched on; the wheel zooms only after a click into the view.
    let turning = false;
    const touch = el("button", {
      type: "button",
      class: "touch-only",
      "aria-pressed": "false",
      text: "Turn with the finger",
    });
    touch.addEventListener("click", () => {
      turning = !turning;
      touch.setAttribute("aria-pressed", String(turning));
      touch.textContent = turning ? "Done turning" : "Turn with the finger";
      canvas.style.touchAction = turning ? "none" : "pan-y";
    });
    canvas.addEventListener(
      "pointerdown",
      (event) => {
        view.controls.enabled = event.pointerType !== "touch" || turning;
        view.controls.enableZoom = true;
      },
      true,
    );
    host.addEventListener("pointerleave", () => {
      view.controls.enableZoom = false;
    });
    const button = (text, label, action) =>
      el("button", { type: "button", text, "aria-label": label, onclick: action });
    return el(
      "div",
      { class: "choice", role: "group", "aria-label": "View" },
      touch,
      button("−", "Move away", () => nudge(view, 0, 0, 1.18)),
      button("+", "Move closer", () => nudge(view, 0, 0, 0.85)),
      button("Reset view", "Reset view", view.home),
    );
  }

  function legend(runs, view) {
    const item = (colour, words, dots) =>
      el("li", {}, Fovea.plots.swatch({ colour, dots }), el("span", { text: words }));
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
    const gl = context(canvas);
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
      el("div", { class: "toolbar under" }, controls.node, steering(view, host, canvas)),
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
