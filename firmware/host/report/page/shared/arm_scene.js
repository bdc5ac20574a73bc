// SPDX-License-Identifier: Apache-2.0
// The objects of a 3-D view: arm, paths, target, workspace, table. `run` needs only the parts that a function reads:
// scene.links [{shapes: [{kind, size, vertices, position, quaternion (w, x, y, z), colour}]}], target {kind, radius_m, corners_m}.

Fovea.armScene = (function () {
  const srgb = (rgb) => new THREE.Color(rgb[0], rgb[1], rgb[2]).convertSRGBToLinear();
  const css = (name) => new THREE.Color(Fovea.theme.colour(name)).convertSRGBToLinear();

  // Normals of loose triangles, smooth across gentle edges and sharp across hard ones.
  function smoothNormals(geometry) {
    geometry.computeVertexNormals();
    const p = geometry.attributes.position.array;
    const flat = geometry.attributes.normal.array.slice();
    const smooth = geometry.attributes.normal.array;
    const sharing = new Map();
    for (let i = 0; i < p.length; i += 3) {
      const key = `${Math.round(p[i] * 2e4)},${Math.round(p[i + 1] * 2e4)},${Math.round(p[i + 2] * 2e4)}`;
      const list = sharing.get(key);
      if (list) list.push(i);
      else sharing.set(key, [i]);
    }
    for (const corners of sharing.values()) {
      for (const i of corners) {
        let x = 0,
          y = 0,
          z = 0;
        for (const k of corners) {
          if (flat[i] * flat[k] + flat[i + 1] * flat[k + 1] + flat[i + 2] * flat[k + 2] < 0.75) continue;
          x += flat[k];
          y += flat[k + 1];
          z += flat[k + 2];
        }
        const size = Math.hypot(x, y, z) || 1;
        smooth[i] = x / size;
        smooth[i + 1] = y / size;
        smooth[i + 2] = z / size;
      }
    }
  }

  function geometryOf(shape) {
    const size = shape.size || [];
    if (shape.kind === "box") return new THREE.BoxBufferGeometry(size[0], size[1], size[2]);
    if (shape.kind === "cylinder")
      return new THREE.CylinderBufferGeometry(size[0], size[0], size[1], 36).rotateX(Math.PI / 2);
    if (shape.kind === "sphere") return new THREE.SphereBufferGeometry(size[0], 32, 20);
    const vertices = shape.kind === "mesh" ? shape.vertices : null;
    if (!vertices || !vertices.length) return null;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(vertices, 3));
    smoothNormals(geometry);
    return geometry;
  }

  // One group for each link; the second run's arm is a pale ghost.
  function arm(run, ghost) {
    const group = new THREE.Group();
    for (const link of run.scene.links || []) {
      const node = new THREE.Group();
      for (const shape of link.shapes || []) {
        const geometry = geometryOf(shape);
        if (!geometry) continue;
        const material = new THREE.MeshStandardMaterial({
          color: srgb(shape.colour || [0.8, 0.8, 0.8]),
          roughness: 0.55,
          metalness: 0.05,
          side: THREE.DoubleSide,
        });
        if (ghost) Object.assign(material, { transparent: true, opacity: 0.38, depthWrite: false });
        const mesh = new THREE.Mesh(geometry, material);
        const [x, y, z] = shape.position || [0, 0, 0];
        const [qw, qx, qy, qz] = shape.quaternion || [1, 0, 0, 0];
        mesh.position.set(x, y, z);
        mesh.quaternion.set(qx, qy, qz, qw);
        mesh.castShadow = !ghost;
        mesh.receiveShadow = !ghost;
        node.add(mesh);
      }
      group.add(node);
    }
    return group;
  }

  // A path as a thin tube, in dashes for the second run.
  function path(flat, colour, dashed, radius) {
    const points = [];
    for (let i = 0; i + 2 < flat.length; i += 3) {
      if (!Number.isFinite(flat[i] + flat[i + 1] + flat[i + 2])) continue; // three.js's vectors turn NaN into 0
      const p = new THREE.Vector3(flat[i], flat[i + 1], flat[i + 2]);
      if (!points.length || points[points.length - 1].distanceTo(p) > 0.004) points.push(p);
    }
    const group = new THREE.Group();
    group.userData.colour = colour;
    if (points.length < 2) return group;
    const curve = new THREE.CatmullRomCurve3(points);
    const length = curve.getLength();
    const pieces = dashed ? Math.max(3, Math.round(length / 0.03)) : 1;
    const material = new THREE.MeshBasicMaterial();
    for (let k = 0; k < pieces; k++) {
      const part = dashed ? curve.getSpacedPoints(pieces * 8).slice(k * 8, k * 8 + 5) : null;
      const line = part ? new THREE.CatmullRomCurve3(part) : curve;
      group.add(
        new THREE.Mesh(
          new THREE.TubeBufferGeometry(line, dashed ? 4 : Math.min(600, points.length * 3), radius, 8),
          material,
        ),
      );
    }
    return group;
  }

  // The target, in its own frame: x and y in its plane, z into it. A ball, a disc or a plate of some thickness
  // behind the painted side.
  function target(run, ghost) {
    const { kind, radius_m: radius, corners_m: corners } = run.target;
    const thick = 0.004;
    let geometry;
    if (kind === "circle") {
      geometry = new THREE.CylinderBufferGeometry(radius, radius, thick, 64).rotateX(Math.PI / 2);
      geometry.translate(0, 0, thick / 2);
    } else if (corners && corners.length >= 6) {
      // The corners are as the servo believes them; the true target may have another size.
      let believed = 0;
      for (let i = 0; i + 1 < corners.length; i += 2)
        believed = Math.max(believed, Math.hypot(corners[i], corners[i + 1]));
      const size = radius > 0 && believed > 0 ? radius / believed : 1;
      const shape = new THREE.Shape();
      for (let i = 0; i + 1 < corners.length; i += 2)
        if (i) shape.lineTo(size * corners[i], size * corners[i + 1]);
        else shape.moveTo(size * corners[i], size * corners[i + 1]);
      geometry = new THREE.ExtrudeBufferGeometry(shape, { depth: thick, bevelEnabled: false });
    } else geometry = new THREE.SphereBufferGeometry(radius || 0.02, 40, 28);
    const mesh = new THREE.Mesh(
      geometry,
      new THREE.MeshStandardMaterial({
        color: 0xb3120a,
        roughness: 0.4,
        transparent: ghost,
        opacity: ghost ? 0.4 : 1,
        side: THREE.DoubleSide,
      }),
    );
    mesh.castShadow = true;
    return mesh;
  }

  // A sphere that shows mostly its rim.
  function workspace(radius) {
    const material = new THREE.ShaderMaterial({
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
      uniforms: { colour: { value: new THREE.Color() }, strength: { value: 0.5 } },
      vertexShader:
        "varying vec3 n; varying vec3 v; void main() { vec4 p = modelViewMatrix * vec4(position, 1.0); n = normalMatrix * normal; v = -p.xyz; gl_Position = projectionMatrix * p; }",
      fragmentShader:
        "uniform vec3 colour; uniform float strength; varying vec3 n; varying vec3 v; void main() { float rim = 1.0 - abs(dot(normalize(n), normalize(v))); gl_FragColor = vec4(colour, strength * (0.03 + pow(rim, 5.0))); }",
    });
    const sphere = new THREE.Mesh(new THREE.SphereBufferGeometry(radius, 64, 40), material);
    sphere.renderOrder = 5;
    return sphere;
  }

  function ring(radius, z) {
    const points = [];
    for (let i = 0; i <= 128; i++)
      points.push(new THREE.Vector3(radius * Math.cos((i * Math.PI) / 64), radius * Math.sin((i * Math.PI) / 64), z));
    return new THREE.Line(
      new THREE.BufferGeometry().setFromPoints(points),
      new THREE.LineBasicMaterial({ transparent: true, opacity: 0.8 }),
    );
  }

  // The table as a grid of 10 cm squares that also takes the shadows.
  function table(z) {
    const points = [];
    for (let i = -10; i <= 10; i++) points.push(i / 10, -1, 0, i / 10, 1, 0, -1, i / 10, 0, 1, i / 10, 0);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    const grid = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.75 }));
    const plane = new THREE.Mesh(new THREE.PlaneBufferGeometry(2, 2), new THREE.ShadowMaterial({ opacity: 0.22 }));
    plane.receiveShadow = true;
    plane.position.z = -0.001;
    const group = new THREE.Group();
    group.add(plane, grid);
    group.position.z = z;
    group.userData.grid = grid;
    return group;
  }

  function lights(scene) {
    const sun = new THREE.DirectionalLight(0xffffff, 0.75);
    sun.position.set(0.8, -1.2, 2.4);
    sun.castShadow = true;
    sun.shadow.mapSize.set(1024, 1024);
    Object.assign(sun.shadow.camera, { left: -1.3, right: 1.3, top: 1.3, bottom: -1.3, near: 0.1, far: 6 });
    sun.shadow.bias = -0.0015;
    sun.shadow.radius = 3;
    const sky = new THREE.HemisphereLight(0xffffff, 0x8a8f98, 0.55);
    sky.position.set(0, 0, 1);
    const fill = new THREE.DirectionalLight(0xffffff, 0.18);
    fill.position.set(-1.5, 1, 1);
    scene.add(sun, sky, fill);
  }

  // The directions x and y of the base, drawn on the table.
  function axes(z) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute(
      "position",
      new THREE.BufferAttribute(new Float32Array([0, 0, z, 0.3, 0, z, 0, 0, z, 0, 0.3, z]), 3),
    );
    const letters = [
      ["x", 0.35, 0],
      ["y", 0, 0.35],
    ].map(([text, x, y]) => {
      const s = letter(text);
      s.position.set(x, y, z);
      return s;
    });
    return { letters, lines: new THREE.LineSegments(geometry, new THREE.LineBasicMaterial()) };
  }

  // A letter that always faces the viewer, for the axes.
  function letter(text) {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = 64;
    const sprite = new THREE.Sprite(
      new THREE.SpriteMaterial({ map: new THREE.CanvasTexture(canvas), transparent: true, depthWrite: false }),
    );
    sprite.scale.set(0.06, 0.06, 1);
    sprite.userData.paint = (colour) => {
      const ctx = canvas.getContext("2d");
      ctx.clearRect(0, 0, 64, 64);
      ctx.font = "600 40px system-ui, sans-serif";
      ctx.textAlign = "center";
      ctx.textBaseline = "middle";
      ctx.fillStyle = colour;
      ctx.fillText(text, 32, 34);
      sprite.material.map.needsUpdate = true;
    };
    return sprite;
  }

  return { arm, path, target, workspace, ring, table, lights, axes, css };
})();
