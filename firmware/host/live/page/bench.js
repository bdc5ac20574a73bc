// SPDX-License-Identifier: Apache-2.0
// The bench in three dimensions: arm and target at the shown moment. It is drawn only when something moved, and more
// rarely and more coarsely on a slow computer.
import { CAMERA_FRAME, TARGET_FRAME, TRUTH } from "./model.js";

const { el, theme, sceneView, armScene } = Fovea;
const LEAST_MS = 55; // between two pictures
const PROBE = 12; // every so many pictures the drawing is timed
const SLOW_MS = 30;
const RATIOS = [2, 1, 0.75, 0.5]; // drawn pixels for each pixel of the page

export class Bench {
  #level = 0;
  #count = 0;
  #probe = 2; // the next picture that is timed
  #started = 0;

  // Null when the browser has no WebGL.
  constructor(host, model, moment, firstKeys) {
    this.model = model;
    this.moment = moment;
    this.canvas = el("canvas", {
      tabindex: "0",
      role: "application",
      "aria-label": "The arm and the target in three dimensions. Arrow keys act as the chosen tool says.",
    });
    this.host = el("div", { class: "scene" }, this.canvas);
    host.append(this.host);
    this.gl = sceneView.context(this.canvas, false);
    if (!this.gl) return;
    this.options = {
      table_z: model.tableZ,
      workspace_radius: model.setup.workspace_radius,
      least_ms: LEAST_MS,
      prepare: () => this.#pose(),
      done: () => this.#measure(),
      paint: () => this.painters.forEach((one) => one()),
    };
    this.painters = [];
    this.view = sceneView.build(this.host, this.canvas, this.gl, this.options);
    this.arm = armScene.arm({ scene: { links: model.links } }, false);
    this.hand = this.#makeHand();
    const { target: kind, target_radius: radius_m, corners: corners_m } = model.setup;
    this.target = kind ? armScene.target({ target: { kind, radius_m, corners_m } }, false) : null;
    this.view.scene.add(this.arm);
    if (this.target) this.view.scene.add(this.target);
    this.steering = sceneView.steering(this.view, this.host, this.canvas, firstKeys);
    this.held = null; // {p, q}: where the target is being dragged to, before the run answers
    this.view.start();
    theme.listen(() => {
      this.view.colours();
      this.view.ask();
    });
    model.listen((what) => {
      if ((what === "motion" || what === "state") && moment.isLive) this.view.ask();
    });
    moment.listen(() => this.view.ask());
  }

  // The middle of the robot's last link: {link, node, p_link}. Called while the arm's nodes are not yet placed.
  #makeHand() {
    const link = this.model.hand;
    const node = this.linkNode(link);
    return node ? { link, node, p_link: new THREE.Box3().setFromObject(node).getCenter(new THREE.Vector3()) } : null;
  }

  // The robot's link at a point of the canvas: {link, node, p_link, p_B}, or null. The camera belongs to the last link.
  pick(ray) {
    const [hit] = ray.intersectObjects(this.arm.children, true);
    if (!hit) return null;
    let node = hit.object;
    while (node.parent !== this.arm) node = node.parent;
    const { frame } = this.model.links[this.arm.children.indexOf(node)];
    const link = frame === CAMERA_FRAME ? this.model.hand : frame;
    node = this.linkNode(link);
    return node ? { link, node, p_link: node.worldToLocal(hit.point.clone()), p_B: hit.point } : null;
  }

  linkNode(frame) {
    return this.arm.children[this.model.links.findIndex((link) => link.frame === frame)];
  }

  // Pose of the target at the shown moment: {p, q} with q = [w, x, y, z], or null.
  targetPose() {
    const { model, moment } = this;
    const { state } = model;
    const row = model.truth.rowAt(moment.t, 0.5);
    if (moment.isLive && state?.target && (state.paused || !row)) return { p: state.target.p_BO, q: state.target.q_BO };
    if (row) return { p: row.subarray(TRUTH.p_BO, TRUTH.p_BO + 3), q: row.subarray(TRUTH.q_BO, TRUTH.q_BO + 4) };
    const seen = model.poseOf(TARGET_FRAME, moment.t);
    return seen ? { p: seen.subarray(0, 3), q: seen.subarray(3, 7) } : null;
  }

  #pose() {
    const { t } = this.moment;
    this.model.links.forEach(({ frame }, i) => {
      const pose = this.model.poseOf(frame, t);
      const node = this.arm.children[i];
      node.visible = !!pose;
      if (!pose) return;
      node.position.set(pose[0], pose[1], pose[2]);
      node.quaternion.set(pose[4], pose[5], pose[6], pose[3]);
    });
    const pose = this.held || this.targetPose();
    if (this.target) {
      this.target.visible = !!pose;
      if (pose) {
        this.target.position.set(...pose.p);
        this.target.quaternion.set(pose.q[1], pose.q[2], pose.q[3], pose.q[0]);
      }
    }
    this.onPose?.();
    this.#tell();
    this.canvas.dataset.pictures = ++this.#count;
    this.#started = performance.now();
  }

  // Where target and hand are in the picture, from 0 to 1, for whoever looks at the page by a program.
  #tell() {
    const { dataset } = this.canvas;
    const at = (node, p_node = new THREE.Vector3()) => {
      node.updateMatrixWorld();
      const p = node.localToWorld(p_node.clone()).project(this.view.camera);
      return JSON.stringify({ x: (p.x + 1) / 2, y: (1 - p.y) / 2 });
    };
    if (this.target?.visible) dataset.target = at(this.target);
    if (this.hand?.node.visible) dataset.hand = at(this.hand.node, this.hand.p_link);
  }

  // Sometimes waits for the picture, to know how long it takes.
  #measure() {
    if (this.#count < this.#probe) return;
    this.#probe = this.#count + PROBE;
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits for the picture
    const cost = performance.now() - this.#started;
    this.options.least_ms = Math.max(LEAST_MS, 3 * cost);
    if (cost > SLOW_MS && this.#level + 1 < RATIOS.length) {
      this.#level++;
      if (this.#level === 2) this.#withoutShadows();
      this.view.limitRatio(RATIOS[this.#level]);
      this.#probe = this.#count + 1; // how long it takes now
    }
  }

  #withoutShadows() {
    this.view.scene.traverse((node) => {
      if (node.isLight) node.castShadow = false;
    });
  }
}
