// SPDX-License-Identifier: Apache-2.0
// The tools with which a person touches the bench: move, turn and throw the target, pull the arm.

const { el, armScene, theme } = Fovea;
const SEND_MS = 33; // between two messages of a drag
const THROW_S = 0.12; // a throw has the mean velocity of this time, or of the last two places that the hand had
const STILL_S = 0.2; // a hand that did not move for so long throws nothing
const MOST_THROW = 5; // [m/s]
const MOST_SPIN = 20; // [rad/s]
const SETTLE_MS = 400; // after the last key, a move by keys ends
const ANSWER_MS = 300; // by then the run has answered a drag
const MIDDLE = "XYZ"; // the handle that moves in all directions of the view, by the name that the library gives it
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
const AFTER = { stay: "it stays there", throw: "it flies on" };

// Keys to a direction in B: +x is right in the first view, +y is away.
const DIRECTIONS = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

// Calls `act` at most once each SEND_MS, and not before the last call has ended. A call that comes too early leads to one
// more at the end, unless it is cancelled.
function throttled(act) {
  let busy = false;
  let again = false;
  const call = async () => {
    again = busy;
    if (busy) return;
    busy = true;
    await Promise.all([act(), new Promise((done) => setTimeout(done, SEND_MS))]);
    busy = false;
    if (again) call();
  };
  call.cancel = () => (again = false);
  return call;
}

export class Hands {
  #tool = "move";
  #after = "stay";
  #trail = []; // the last poses of a drag: {at [s], p, q}
  #moved = 0; // when the hand moved, or let go, last [s]
  #pull = null; // {node, link, p_link, to_B, plane}
  #pulling = false; // a request is on its way
  #controlled = false; // this page had control at the last message
  #taken = false; // the target was moved and not yet let go
  #sendPose = throttled(() => this.actions.holdTarget(this.bench.held.p, this.bench.held.q));
  #sendPull = throttled(() => this.#askForPull());

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
    this.node = this.#toolbar();
    this.#choose("move");
    this.model.listen((what) => {
      if (what === "state") this.#allow();
      const lost = this.#controlled && !actions.inControl;
      this.#controlled = actions.inControl;
      if (lost || what === "reset") this.#dropPull();
    });
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
    return el("div", { class: "toolbar hands" }, this.tools, this.afterLabel);
  }

  #choose(tool) {
    this.#endPull();
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
      clearTimeout(this.settle);
      if (value) this.#trail = [];
      else this.#letGo(this.#after === "throw");
    });
    this.gizmo.addEventListener("objectChange", () => this.#drag());
    this.#preferMiddle();
    // When the hand moved, not when a slow page came to know it.
    for (const kind of ["pointerdown", "pointermove", "pointerup"])
      addEventListener(kind, (event) => (this.#moved = event.timeStamp / 1000), true);
  }

  // Who takes the target itself moves it across the view, also where an arrow points at the viewer and lies before it: on
  // such an arrow a pixel would be a long way.
  #preferMiddle() {
    const { gizmo } = this;
    const ray = new THREE.Raycaster();
    const hover = gizmo.pointerHover;
    gizmo.pointerHover = (pointer) => {
      hover.call(gizmo, pointer);
      if (!gizmo.axis || gizmo.dragging || gizmo.mode !== "translate") return;
      ray.setFromCamera(pointer, gizmo.camera);
      const middle = gizmo.getObjectByName(MIDDLE);
      if (ray.intersectObject(middle).length) gizmo.axis = MIDDLE;
    };
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
    this.#hold(pose);
    this.#trail.push({ at: this.#moved, ...pose });
    this.#trail = this.#trail.filter(({ at }, i, all) => i >= all.length - 2 || this.#moved - at < THROW_S);
  }

  #hold(pose) {
    this.bench.held = pose;
    this.#taken = true;
    this.#sendPose();
  }

  // The end of a drag: the last pose is sent; then the target is let go, or thrown.
  async #letGo(thrown) {
    this.#sendPose.cancel();
    this.settle = setTimeout(() => {
      this.bench.held = null;
      this.bench.view.ask();
    }, ANSWER_MS);
    if (!this.#taken) return;
    this.#taken = false;
    const { p, q } = this.bench.held;
    const velocity = this.#velocity();
    const sent = await this.actions.holdTarget(p, q);
    if (!sent || this.#taken) return; // refused, or another drag has begun
    if (thrown) this.actions.call("/target/throw", velocity);
    else this.actions.releaseTarget();
  }

  #velocity() {
    const [a, b] = [this.#trail[0], this.#trail[this.#trail.length - 1]];
    const dt = a && b.at - a.at;
    if (!(dt > 0) || this.#moved - b.at > STILL_S) return { v_BO: [0, 0, 0], omega_B: [0, 0, 0] };
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
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    if (event.key === "Escape") return this.#endPull();
    if (!this.moment.isLive) return false;
    const direction = DIRECTIONS[event.key];
    const steps = event.shiftKey ? 5 : 1;
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
    this.#hold(this.#pose());
    clearTimeout(this.settle);
    this.settle = setTimeout(() => this.#letGo(false), SETTLE_MS);
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
        if (this.#pull?.plane) this.#endPull();
      });
  }

  async #askForPull() {
    const pull = this.#pull;
    const { link, p_link, to_B } = pull;
    this.#pulling = true;
    const answer = await this.actions.call("/arm/pull", { link, p_link: p_link.toArray(), to_B: to_B.toArray() });
    this.#pulling = false;
    if (!answer && this.#pull === pull) this.#dropPull();
    if (answer && !this.#pull) this.#release();
  }

  // True when there was a pull, be it only the run's own one.
  #endPull() {
    const pulled = !!this.#pull || (!!this.model.state?.pull && this.actions.inControl);
    this.#dropPull();
    if (pulled && !this.#pulling) this.#release(); // otherwise when the answer comes
    return pulled;
  }

  #dropPull() {
    if (this.#pull?.plane) this.bench.view.controls.enabled = true;
    this.#pull = null;
    this.#sendPull.cancel();
    this.bench.view.ask();
  }

  #release() {
    if (this.actions.inControl) this.actions.call("/arm/release");
  }

  #pullByKey(offset) {
    if (!this.#pull) {
      const { hand } = this.bench;
      if (!hand) return;
      hand.node.updateMatrixWorld();
      this.#pull = { ...hand, to_B: hand.node.localToWorld(hand.p_link.clone()) };
    }
    this.#pull.to_B.add(new THREE.Vector3(...offset));
    this.#sendPull();
    this.bench.view.ask();
  }
}
