// SPDX-License-Identifier: Apache-2.0
// The tools with which a person touches the bench: move, turn and throw the target, pull the arm.

const { el, armScene, theme } = Fovea;
const SEND_MS = 33; // between two messages of a drag
const THROW_S = 0.12; // a throw has the mean velocity of this time
const MOST_THROW = 5; // [m/s]
const MOST_SPIN = 20; // [rad/s]
const STEP_M = 0.01;
const STEP_RAD = Math.PI / 36;

const TOOLS = {
  move: {
    words: "Move target",
    hint: "Drag the target's arrows, or the target itself. Keys: arrows, Page Up and Page Down.",
  },
  turn: { words: "Turn target", hint: "Drag the rings. Keys: arrows, Page Up and Page Down." },
  pull: {
    words: "Pull arm",
    hint: "Drag a link: a spring pulls it to the pointer. Keys: arrows pull the hand, Esc lets go.",
  },
  look: { words: "Look", hint: "Drag to turn the view; drag with the right button to move it. Keys: arrows, + and −." },
};
const AFTER = { stay: "it stays there", free: "it moves on as planned", throw: "it flies on" };

// Keys to a direction in B: +x is right in the first view, +y is away.
const DIRECTIONS = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

export class Hands {
  #tool = "move";
  #after = "stay";
  #trail = []; // the last poses of a drag: {at [s], p, q}
  #sent = 0;
  #pull = null; // {node, link, p_link, to_B, plane}
  #pulling = false; // a request is on its way

  constructor(bench, actions, moment) {
    this.bench = bench;
    this.actions = actions;
    this.moment = moment;
    this.model = bench.model;
    this.#makeGizmo();
    this.#makeSpring();
    this.#followPointer();
    bench.onPose = () => this.#place();
    this.hint = el("p", { class: "hint no-print" });
    this.release = el("button", { type: "button", text: "Let the target go", onclick: () => this.#letGo("free") });
    this.node = this.#toolbar();
    this.#choose("move");
    this.model.listen((what) => what === "state" && this.#allow());
    moment.listen(() => this.#allow());
  }

  #toolbar() {
    this.tools = Fovea.choice(
      "Tool",
      Object.entries(TOOLS).map(([key, { words }]) => [key, words]),
      "move",
      (key) => this.#choose(key),
    );
    this.after = el(
      "select",
      { "aria-label": "What the target does when it is let go", onchange: () => (this.#after = this.after.value) },
      Object.entries(AFTER).map(([value, words]) => el("option", { value, text: words })),
    );
    this.afterLabel = el("label", { class: "after" }, "After a drag ", this.after);
    return el("div", { class: "toolbar hands" }, this.tools, this.afterLabel, this.release);
  }

  #choose(tool) {
    this.#tool = tool;
    this.hint.textContent = TOOLS[tool].hint;
    if (tool !== "look" && tool !== "pull") this.gizmo.setMode(tool === "turn" ? "rotate" : "translate");
    this.bench.canvas.classList.toggle("pulls", tool === "pull");
    this.#allow();
    this.bench.view.ask();
  }

  // Hides what this run does not offer.
  #allow() {
    const target = !!this.bench.target && this.actions.may("target");
    const pull = this.actions.may("/arm/pull");
    const [move, turn, pulls] = this.tools.children;
    move.disabled = turn.disabled = !target;
    pulls.disabled = !pull;
    this.afterLabel.hidden = !target;
    this.after.querySelector('[value="throw"]').disabled = !this.actions.may("/target/throw");
    this.release.hidden = !this.model.state?.target?.held || !target;
    const shown = target && this.moment.isLive && (this.#tool === "move" || this.#tool === "turn");
    if (shown !== !!this.gizmo.object) {
      if (shown) this.gizmo.attach(this.handle);
      else this.gizmo.detach();
      this.bench.view.ask();
    }
  }

  #makeGizmo() {
    const { view, canvas } = this.bench;
    this.handle = new THREE.Object3D();
    view.scene.add(this.handle);
    this.gizmo = new THREE.TransformControls(view.camera, canvas);
    this.gizmo.setSize(0.7);
    view.scene.add(this.gizmo);
    this.gizmo.addEventListener("change", view.ask);
    this.gizmo.addEventListener("dragging-changed", ({ value }) => {
      view.controls.enabled = !value;
      if (value) this.#trail = [];
      else this.#letGo(this.#after);
    });
    this.gizmo.addEventListener("objectChange", () => this.#drag());
  }

  #place() {
    const pose = this.gizmo.dragging ? null : this.bench.targetPose();
    if (pose && !this.bench.held) {
      this.handle.position.set(...pose.p);
      this.handle.quaternion.set(pose.q[1], pose.q[2], pose.q[3], pose.q[0]);
    }
    this.#drawSpring();
  }

  #pose() {
    const { position: p, quaternion: q } = this.handle;
    q.normalize();
    return { p: [p.x, p.y, p.z], q: [q.w, q.x, q.y, q.z] };
  }

  #drag() {
    const pose = this.#pose();
    this.bench.held = pose;
    this.#trail.push({ at: performance.now() / 1000, ...pose });
    this.#trail = this.#trail.filter(({ at }) => performance.now() / 1000 - at < THROW_S);
    if (performance.now() - this.#sent < SEND_MS) return;
    this.#sent = performance.now();
    this.actions.holdTarget(pose.p, pose.q);
  }

  // The end of a drag: the last pose is sent; then the target stays, moves on, or flies.
  async #letGo(how) {
    if (this.bench.held) await this.actions.holdTarget(this.bench.held.p, this.bench.held.q);
    if (how === "free") await this.actions.releaseTarget();
    if (how === "throw") await this.actions.call("/target/throw", this.#velocity());
    setTimeout(() => {
      if (this.gizmo.dragging) return;
      this.bench.held = null; // by now the run has answered
      this.bench.view.ask();
    }, 300);
  }

  #velocity() {
    const [a, b] = [this.#trail[0], this.#trail[this.#trail.length - 1]];
    const dt = a && performance.now() / 1000 - a.at;
    if (!a || a === b || dt > 2 * THROW_S) return { v_BO: [0, 0, 0], omega_B: [0, 0, 0] };
    const limited = (list, most) => {
      const size = Math.hypot(...list);
      return list.map((x) => (size > most ? (x * most) / size : x));
    };
    const quaternion = ([w, x, y, z]) => new THREE.Quaternion(x, y, z, w);
    const turn = quaternion(b.q).multiply(quaternion(a.q).inverse());
    const angle = 2 * Math.acos(Math.min(1, Math.abs(turn.w))) * Math.sign(turn.w || 1);
    const axis = new THREE.Vector3(turn.x, turn.y, turn.z).normalize();
    return {
      v_BO: limited(
        b.p.map((x, i) => (x - a.p[i]) / dt),
        MOST_THROW,
      ),
      omega_B: limited(
        axis.toArray().map((x) => (x * angle) / dt),
        MOST_SPIN,
      ),
    };
  }

  // True when a key was the tool's.
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || !this.moment.isLive) return false;
    const direction = DIRECTIONS[event.key];
    const steps = event.shiftKey ? 5 : 1;
    if (this.#tool === "pull" && event.key === "Escape") {
      this.#endPull();
      return true;
    }
    if (!direction || this.#tool === "look") return false;
    if (this.#tool === "pull") this.#pullByKey(direction.map((x) => 5 * x * STEP_M * steps));
    else if (this.gizmo.object) this.#nudge(direction, steps);
    else return false;
    return true;
  }

  #nudge(direction, steps) {
    const axis = new THREE.Vector3(...direction);
    if (this.#tool === "move") this.handle.position.addScaledVector(axis, STEP_M * steps);
    else this.handle.quaternion.premultiply(new THREE.Quaternion().setFromAxisAngle(axis, STEP_RAD * steps));
    this.bench.held = this.#pose();
    clearTimeout(this.settle);
    this.settle = setTimeout(() => this.#letGo(this.#after === "throw" ? "stay" : this.#after), 400);
    this.actions.holdTarget(this.bench.held.p, this.bench.held.q);
    this.bench.view.ask();
  }

  #makeSpring() {
    const material = new THREE.MeshBasicMaterial();
    this.rod = new THREE.Mesh(new THREE.CylinderBufferGeometry(0.004, 0.004, 1, 8).rotateX(Math.PI / 2), material);
    this.knob = new THREE.Mesh(new THREE.SphereBufferGeometry(0.014, 16, 12), material);
    this.rod.visible = this.knob.visible = false;
    this.bench.view.scene.add(this.rod, this.knob);
    const paint = () => material.color.copy(armScene.css("--purple"));
    this.bench.painters.push(paint);
    paint();
    theme.listen(paint);
  }

  #drawSpring() {
    const told = this.model.state?.pull;
    const node = this.#pull ? this.#pull.node : told && this.bench.linkNode(told.link);
    const shown = !!node && this.moment.isLive;
    this.rod.visible = this.knob.visible = shown;
    if (!shown) return;
    node.updateMatrixWorld();
    const from = this.#pull ? node.localToWorld(this.#pull.p_link.clone()) : node.getWorldPosition(new THREE.Vector3());
    const to = this.#pull ? this.#pull.to_B : new THREE.Vector3(...told.to_B);
    this.rod.position.copy(from).add(to).multiplyScalar(0.5);
    this.rod.scale.set(1, 1, Math.max(1e-4, from.distanceTo(to)));
    this.rod.lookAt(to);
    this.knob.position.copy(to);
  }

  #followPointer() {
    const { canvas, view } = this.bench;
    const ray = new THREE.Raycaster();
    const aim = (event) => {
      const box = canvas.getBoundingClientRect();
      ray.setFromCamera(
        {
          x: ((event.clientX - box.left) / box.width) * 2 - 1,
          y: 1 - ((event.clientY - box.top) / box.height) * 2,
        },
        view.camera,
      );
    };
    canvas.addEventListener(
      "pointerdown",
      (event) => {
        if (this.#tool !== "pull" || event.button !== 0 || !this.moment.isLive) return;
        aim(event);
        const picked = this.bench.pick(ray);
        if (!picked) return;
        view.controls.enabled = false;
        canvas.setPointerCapture(event.pointerId);
        const normal = view.camera.getWorldDirection(new THREE.Vector3());
        const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, picked.p_B);
        this.#pull = { ...picked, plane, to_B: picked.p_B.clone() };
        event.preventDefault();
      },
      true,
    );
    canvas.addEventListener("pointermove", (event) => {
      if (!this.#pull?.plane) return;
      aim(event);
      if (ray.ray.intersectPlane(this.#pull.plane, this.#pull.to_B)) this.#sendPull();
      view.ask();
    });
    for (const end of ["pointerup", "pointercancel"])
      canvas.addEventListener(end, () => {
        if (!this.#pull?.plane) return;
        view.controls.enabled = true;
        this.#endPull();
      });
  }

  // One request at a time: a slow answer does not make a queue.
  async #sendPull() {
    if (this.#pulling || performance.now() - this.#sent < SEND_MS) return;
    this.#sent = performance.now();
    this.#pulling = true;
    const { link, p_link, to_B } = this.#pull;
    const answer = await this.actions.call("/arm/pull", { link, p_link: p_link.toArray(), to_B: to_B.toArray() });
    this.#pulling = false;
    if (!answer) this.#pull = null;
    else if (!this.#pull) this.actions.call("/arm/release");
  }

  #endPull() {
    const was = this.#pull;
    this.#pull = null;
    if (was && !this.#pulling) this.actions.call("/arm/release");
    this.bench.view.ask();
  }

  #pullByKey(offset) {
    if (!this.#pull) {
      const links = this.model.links.map(({ frame }) => frame);
      const link = links[links.length - 1];
      const node = this.bench.linkNode(link);
      this.#pull = { node, link, p_link: new THREE.Vector3(), to_B: node.getWorldPosition(new THREE.Vector3()) };
    }
    this.#pull.to_B.add(new THREE.Vector3(...offset));
    this.#sendPull();
    this.bench.view.ask();
  }
}
