// SPDX-License-Identifier: Apache-2.0
// The stage of a 3-D view: renderer, light, table, workspace, and a camera that is turned with mouse, finger or keys.

Fovea.sceneView = (function () {
  const { el, theme } = Fovea;
  const make = Fovea.armScene;

  // The drawing context of a canvas; null when the browser offers none. `keep`: the picture can be copied later.
  function context(canvas, keep) {
    try {
      return canvas.getContext("webgl", { antialias: true, alpha: false, preserveDrawingBuffer: keep });
    } catch (trouble) {
      return null;
    }
  }

  // A view into `host`. Options: table_z and workspace_radius [m], keep (as above), paint() sets the colours of the objects
  // that the caller adds, prepare() and done() are called before and after each picture, least_ms is the time between two pictures, or more.
  // Call start() when all objects are in `scene`.
  function build(host, canvas, gl, options) {
    const { keep, workspace_radius: radius } = options;
    const renderer = new THREE.WebGLRenderer({ canvas, context: gl, antialias: true, preserveDrawingBuffer: keep });
    renderer.gammaOutput = true;
    renderer.gammaFactor = 2.2;
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    const scene = new THREE.Scene();
    make.lights(scene);
    const floor = Number.isFinite(options.table_z) ? options.table_z : 0;
    const table = make.table(floor);
    scene.add(table);
    const sphere = radius ? make.workspace(radius) : null;
    const circle =
      radius && radius > Math.abs(floor) ? make.ring(Math.sqrt(radius * radius - floor * floor), floor + 0.001) : null;
    if (sphere) scene.add(sphere);
    if (circle) scene.add(circle);
    const axes = make.axes(floor + 0.002);
    scene.add(axes.lines, ...axes.letters);

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
    let drawn = 0;
    let mostRatio = 2;
    const render = () => {
      asked = false;
      drawn = performance.now();
      if (options.prepare) options.prepare();
      renderer.render(scene, camera);
      if (options.done) options.done();
    };
    // Draws soon, however often it is called.
    const ask = () => {
      if (asked) return;
      asked = true;
      const wait = (options.least_ms || 0) - (performance.now() - drawn);
      if (wait > 0) setTimeout(() => requestAnimationFrame(render), wait);
      else requestAnimationFrame(render);
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
      if (options.paint) options.paint();
    };
    const resize = () => {
      const width = host.clientWidth;
      const height = host.clientHeight;
      if (!width || !height) return;
      renderer.setPixelRatio(Math.min(mostRatio, devicePixelRatio || 1));
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
    };
    // The largest number of drawn pixels for each pixel of the page, along a side.
    const limitRatio = (most) => {
      mostRatio = most;
      resize();
      render(); // a canvas of another size is empty
    };
    const start = () => {
      controls.addEventListener("change", ask);
      resize();
      colours();
      home();
      new ResizeObserver(() => {
        resize();
        render();
      }).observe(host);
    };
    return { scene, renderer, controls, camera, floor, render, ask, home, colours, limitRatio, start };
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

  // The keys of the canvas, and buttons for the view. Keys that `first(event)` takes (it returns true) are not the view's.
  function steering(view, host, canvas, first = () => false) {
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
      if (first(event)) event.preventDefault();
      else if (moves[event.key] && !event.ctrlKey && !event.metaKey && !event.altKey) {
        nudge(view, ...moves[event.key]);
        event.preventDefault();
      }
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

  return { context, build, steering };
})();
