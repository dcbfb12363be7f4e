// SPDX-License-Identifier: GPL-3.0-or-later
// An organ in three dimensions: its contact surface with colours, regions, sites, held-out contacts, a tool, a dent.
import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DirectionalLight, Group, LineBasicMaterial,
  LineSegments, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Points, PointsMaterial, Quaternion,
  Raycaster, Scene, ShaderMaterial, SphereGeometry, CapsuleGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { acceleratedRaycast, MeshBVH } from "three-mesh-bvh";
import { NEUTRAL, parse, sequential } from "./colour.js";

const FIELD = 32; // degrees, vertical angle of view
const MOST_TRIANGLES = 20000; // that are split into four
const SLOW = 34, FAST = 14; // ms between frames, beyond which the resolution of moving pictures falls or rises
const STILL = 250; // ms without a change, after which the picture is drawn finely

/** Splits every triangle into four. */
function subdivide({ position, normal, index, sites, weights }) {
  const middles = new Map();
  const out = { position: [...position], normal: [...normal], index: [], parents: [] };
  const count = position.length / 3;
  const middle = (a, b) => {
    const key = a < b ? a * count + b : b * count + a;
    let at = middles.get(key);
    if (at !== undefined) return at;
    at = out.position.length / 3;
    middles.set(key, at);
    const n = new Vector3();
    for (let k = 0; k < 3; k++) {
      out.position.push((position[3 * a + k] + position[3 * b + k]) / 2);
      n.setComponent(k, normal[3 * a + k] + normal[3 * b + k]);
    }
    n.normalize();
    out.normal.push(n.x, n.y, n.z);
    out.parents.push(a, b);
    return at;
  };
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = index.slice(t, t + 3);
    const ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    out.index.push(a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca);
  }
  return {
    position: Float32Array.from(out.position),
    normal: Float32Array.from(out.normal),
    index: Uint32Array.from(out.index),
    parents: Uint32Array.from(out.parents),
    coarse: { sites, weights, count },
  };
}

// The dent of a sphere of radius R on an elastic half-space (Hertz; Johnson, Contact Mechanics, 1985, section 3.4):
// with a^2 = R depth, u = depth (1 - r^2 / 2 a^2) inside a, u = depth / pi ((2 - r^2/a^2) asin(a/r) + sqrt(r^2/a^2 - 1))
// outside.
const DENT = `
uniform vec3 dentAt; uniform vec3 dentNormal; uniform float dentDepth; uniform float dentRadius;
vec2 dent(vec3 p) {
  if (dentDepth <= 0.0) return vec2(0.0);
  vec3 d = p - dentAt;
  float below = dot(d, dentNormal);
  float r = length(d - below * dentNormal);
  float a = sqrt(dentRadius * dentDepth);
  float q = r / a;
  if (q > 9.0 || below < -6.0 * a) return vec2(0.0);
  float u, slope;
  if (q <= 1.0) {
    u = 1.0 - 0.5 * q * q; slope = -q;
  } else {
    float root = sqrt(q * q - 1.0), angle = asin(1.0 / q);
    u = ((2.0 - q * q) * angle + root) / 3.14159265; slope = 2.0 * (root / q - q * angle) / 3.14159265;
  }
  float reach = smoothstep(-6.0 * a, -2.0 * a, below) * (1.0 - smoothstep(4.0 * a, 9.0 * a, r));
  return dentDepth * reach * vec2(u, slope / a);
}`;

function surfaceMaterial() {
  return new ShaderMaterial({
    uniforms: {
      dentAt: { value: new Vector3() }, dentNormal: { value: new Vector3(0, 0, 1) },
      dentDepth: { value: 0 }, dentRadius: { value: 0.005 },
      opacity: { value: 1 }, dark: { value: 0 },
    },
    vertexShader: `
      attribute vec3 tint; attribute float support;
      varying vec3 vTint; varying vec3 vNormal3; varying vec3 vPlace; varying vec3 vView; varying float vSupport;
      ${DENT}
      void main() {
        vec2 u = dent(position);
        vec3 p = position - u.x * dentNormal;
        vTint = tint; vSupport = support; vPlace = position; vNormal3 = normal;
        vec4 eye = modelViewMatrix * vec4(p, 1.0);
        vView = eye.xyz;
        gl_Position = projectionMatrix * eye;
      }`,
    fragmentShader: `
      uniform float opacity; uniform float dark;
      varying vec3 vTint; varying vec3 vNormal3; varying vec3 vPlace; varying vec3 vView; varying float vSupport;
      ${DENT}
      void main() {
        vec3 n = normalize(vNormal3);
        vec2 u = dent(vPlace);
        vec3 d = vPlace - dentAt;
        vec3 radial = d - dot(d, dentNormal) * dentNormal;
        float r = length(radial);
        if (r > 1e-9) n = normalize(n + u.y * radial / r);
        vec3 eye = normalize((viewMatrix * vec4(n, 0.0)).xyz);
        vec3 toEye = normalize(-vView);
        float key = max(dot(eye, normalize(vec3(-0.35, 0.7, 0.65))), 0.0);
        float fill = max(dot(eye, normalize(vec3(0.8, -0.1, 0.5))), 0.0);
        float rim = pow(1.0 - max(dot(eye, toEye), 0.0), 3.0);
        float gloss = pow(max(dot(eye, normalize(vec3(-0.35, 0.7, 0.65) + toEye)), 0.0), 40.0);
        vec3 tint = vTint;
        float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0));
        tint = mix(tint, mix(vec3(0.62), vec3(0.52), stripe), clamp(vSupport * 1.3, 0.0, 0.85));
        vec3 c = tint * (0.5 + 0.48 * key + 0.16 * fill) + 0.10 * gloss + mix(-0.10, 0.16, dark) * rim;
        gl_FragColor = vec4(c, opacity);
      }`,
    transparent: true,
  });
}

const toolMaterial = () => new MeshLambertMaterial({ color: 0xc8ced1, transparent: true, opacity: 0.92 });

/** A tool as its record in the file draws it: a ball, a capsule along z, or a disc, with a handle along z. */
function toolMesh(tool, size) {
  const group = new Group();
  const radius = tool.probe_radius_m > 0 ? tool.probe_radius_m : tool.radius_m;
  const length = tool.axis_length_m;
  const along = (mesh, from, to) => {
    mesh.rotation.x = Math.PI / 2;
    mesh.position.z = (from + to) / 2;
    group.add(mesh);
  };
  if (!(tool.probe_radius_m > 0)) {
    along(new Mesh(new CylinderGeometry(radius, radius, 0.3 * radius, 48), toolMaterial()), 0, 0.3 * radius);
  } else if (length > 0) {
    along(new Mesh(new CapsuleGeometry(radius, length, 8, 32), toolMaterial()), 0, length);
  } else {
    group.add(new Mesh(new SphereGeometry(radius, 32, 20), toolMaterial()));
  }
  const handle = Math.max(0.35 * size, 5 * radius);
  along(new Mesh(new CylinderGeometry(0.22 * radius, 0.22 * radius, handle, 16), toolMaterial()), length + 0.6 * radius, length + 0.6 * radius + handle);
  return group;
}

function arrow(colour) {
  const group = new Group();
  const material = new MeshBasicMaterial({ color: colour, depthTest: false, transparent: true });
  const shaft = new Mesh(new CylinderGeometry(1, 1, 1, 12), material);
  const head = new Mesh(new CylinderGeometry(0, 2.6, 1, 16), material);
  group.add(shaft, head);
  group.renderOrder = 10;
  shaft.renderOrder = head.renderOrder = 10;
  group.point = (at, vector, length, width) => {
    group.visible = length > 2 * width;
    if (!group.visible) return;
    const headLength = Math.min(6 * width, 0.5 * length);
    shaft.scale.set(width, length - headLength, width);
    shaft.position.y = (length - headLength) / 2;
    head.scale.set(width, headLength, width);
    head.position.y = length - headLength / 2;
    group.position.copy(at);
    group.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), vector);
  };
  group.visible = false;
  return group;
}

export class OrganView {
  /** `palp`: the open file; `organ`: its section of the numbers. Throws where the browser has no WebGL. */
  constructor(canvas, palp, organ, heldOut = []) {
    this.canvas = canvas;
    this.organ = organ;
    this.renderer = new WebGLRenderer({ canvas, alpha: true, preserveDrawingBuffer: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(FIELD, 1, 0.001, 10);
    this.caster = new Raycaster();
    this.frames = 0;
    this.moving = { ratio: 1, interval: 20, last: -Infinity, going: false };

    const coarse = {
      position: palp.positions(), normal: palp.normals(), index: palp.triangles(),
      sites: palp.vertexSites(), weights: palp.vertexWeights(),
    };
    this.coarse = coarse;
    this.pickable = new Mesh(this.#geometry(coarse), new MeshBasicMaterial());
    this.pickable.raycast = acceleratedRaycast;
    this.pickable.geometry.boundsTree = new MeshBVH(this.pickable.geometry);
    this.caster.firstHitOnly = true;
    const fine = coarse.index.length / 3 * 4 <= MOST_TRIANGLES ? subdivide(coarse) : coarse;
    this.fine = fine;
    this.geometry = this.#geometry(fine);
    const vertices = fine.position.length / 3;
    this.geometry.setAttribute("tint", new BufferAttribute(new Float32Array(3 * vertices), 3));
    this.geometry.setAttribute("support", new BufferAttribute(this.#spread((site) => organ.sites.held[site]), 1));
    this.material = surfaceMaterial();
    this.surface = new Mesh(this.geometry, this.material);
    this.scene.add(this.surface);

    this.geometry.computeBoundingSphere();
    const { center, radius } = this.geometry.boundingSphere;
    this.size = radius;
    this.#addRegions();
    this.#addSites(heldOut);
    this.scene.add(new AmbientLight(0xffffff, 1.6));
    const light = new DirectionalLight(0xffffff, 1.8);
    light.position.set(-0.4, 0.8, 0.7);
    this.camera.add(light);
    this.scene.add(this.camera);
    this.force = arrow(0xd55e00);
    this.scene.add(this.force);

    this.camera.up.set(0, 0, 1);
    const towards = new Vector3(0.75, -1.25, 0.85).normalize();
    this.camera.position.copy(center).addScaledVector(towards, 3.1 * radius);
    this.camera.near = 0.02 * radius;
    this.camera.far = 20 * radius;
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.copy(center);
    this.controls.addEventListener("change", () => this.invalidate());
    this.controls.update();
    new ResizeObserver(() => this.#resize()).observe(canvas);
    this.#resize();
  }

  #geometry({ position, normal, index }) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(position, 3));
    geometry.setAttribute("normal", new BufferAttribute(normal, 3));
    geometry.setIndex(new BufferAttribute(index, 1));
    return geometry;
  }

  /** A number per vertex from a number per site, by the weights that the runtime blends with. */
  #spread(valueOf) {
    const { sites, weights } = this.coarse;
    const count = sites.length / 3;
    const values = new Float32Array(this.fine.position.length / 3);
    for (let v = 0; v < count; v++) {
      for (let k = 0; k < 3; k++) values[v] += weights[3 * v + k] * (valueOf(sites[3 * v + k]) ?? 0);
    }
    const parents = this.fine.parents ?? [];
    for (let k = 0; 2 * k < parents.length; k++) values[count + k] = (values[parents[2 * k]] + values[parents[2 * k + 1]]) / 2;
    return values;
  }

  #addRegions() {
    this.regions = new Group();
    const palette = ["#d55e00", "#cc79a7", "#0072b2", "#009e73", "#e69f00", "#56b4e9"];
    for (const [k, region] of (this.organ.regions ?? []).entries()) {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(Float32Array.from(region.points_m.flat()), 3));
      geometry.setIndex(new BufferAttribute(Uint32Array.from(region.triangles.flat()), 1));
      geometry.computeVertexNormals();
      const mesh = new Mesh(geometry, new MeshLambertMaterial({ color: palette[k % palette.length], transparent: true, opacity: 0.38, depthTest: false, depthWrite: false }));
      mesh.renderOrder = 3;
      this.regions.add(mesh);
    }
    this.scene.add(this.regions);
  }

  #addSites(heldOut) {
    const points = (list, colours, size) => {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(Float32Array.from(list.flat()), 3));
      if (colours) geometry.setAttribute("color", new BufferAttribute(Float32Array.from(colours.flat()), 3));
      return new Points(geometry, new PointsMaterial({ size, sizeAttenuation: false, vertexColors: Boolean(colours), color: colours ? 0xffffff : 0x1d2326 }));
    };
    const lift = 0.004 * this.size;
    const above = (p, n) => p.map((x, k) => x + lift * n[k]);
    const { position_m, normal } = this.organ.sites;
    this.sites = points(position_m.map((p, k) => above(p, normal[k])), null, 4);
    this.sites.visible = false;
    const worst = 0.2;
    this.heldOut = points(heldOut.map((h) => above(h.c_m, h.n)), heldOut.map((h) => (h.accepted ? sequential(h.error / worst) : parse("#d55e00"))), 11);
    this.heldOut.visible = false;
    const ring = new BufferGeometry();
    ring.setAttribute("position", new BufferAttribute(Float32Array.from(heldOut.flatMap((h) => [...above(h.c_m, h.n), ...above(h.c_m, h.n.map((x) => 12 * x))])), 3));
    this.heldOut.add(new LineSegments(ring, new LineBasicMaterial({ color: 0x777777 })));
    this.scene.add(this.sites, this.heldOut);
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.camera.aspect = width / height;
    // A narrow picture still has the whole width of the organ.
    this.camera.fov = (360 / Math.PI) * Math.atan(Math.tan((FIELD * Math.PI) / 360) * Math.max(1, 1.2 / this.camera.aspect));
    this.camera.updateProjectionMatrix();
    this.invalidate();
  }

  /** Colours by a field (fields.js), between the ends of `range`. */
  colour(field, range) {
    const tint = this.geometry.getAttribute("tint");
    const colours = field.values.map((value) =>
      field.categories ? parse(field.categories[value] ?? NEUTRAL)
        : Number.isFinite(value) ? sequential((value - range[0]) / (range[1] - range[0])) : null);
    const parts = [0, 1, 2].map((channel) => this.#spreadColour(colours, channel));
    for (let v = 0; v < tint.count; v++) tint.setXYZ(v, parts[0][v], parts[1][v], parts[2][v]);
    tint.needsUpdate = true;
    this.invalidate();
  }
  #spreadColour(colours, channel) {
    const neutral = parse(NEUTRAL)[channel];
    return this.#spread((site) => colours[site]?.[channel] ?? neutral);
  }

  takeTool(index) {
    if (this.tool) this.scene.remove(this.tool);
    this.tool = toolMesh(this.organ.tools[index], this.size);
    this.tool.visible = false;
    this.shown = null;
    this.scene.add(this.tool);
    this.material.uniforms.dentRadius.value = Math.max(this.organ.tools[index].probe_radius_m || this.organ.tools[index].radius_m, 1e-4);
    this.invalidate();
  }

  /** The tool at a pose [x, y, z, w, x, y, z] with a tick of it; null: no tool. */
  show(pose, tick, newtonsPerRadius) {
    // A tool that rests leaves the picture as it is.
    const shown = pose ? [...pose, tick?.depth ?? 0, ...(tick?.force ?? [])] : null;
    if (shown && this.shown?.every((x, k) => Math.abs(x - shown[k]) < 1e-7)) return;
    this.shown = shown;
    this.tool.visible = Boolean(pose);
    const touching = pose && tick && (tick.state === 1 || tick.state === 2);
    if (pose) {
      this.tool.position.set(pose[0], pose[1], pose[2]);
      this.tool.quaternion.set(pose[4], pose[5], pose[6], pose[3]);
    }
    const u = this.material.uniforms;
    u.dentDepth.value = touching ? tick.depth : 0;
    this.force.visible = false;
    if (touching) {
      u.dentAt.value.set(...tick.bodyPoint);
      u.dentNormal.value.set(...tick.normal);
      const force = new Vector3(...tick.force);
      const size = force.length();
      if (size > 0) this.force.point(new Vector3(...tick.toolPoint), force.normalize(), (size / newtonsPerRadius) * this.size, 0.008 * this.size);
    }
    this.invalidate();
  }

  /** The point of the undeformed surface under a place of the canvas (client pixels): {point, normal, site}, or null. */
  pick(x, y) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2((2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height);
    this.caster.setFromCamera(at, this.camera);
    const [hit] = this.caster.intersectObject(this.pickable);
    if (!hit) return null;
    const { a, b, c } = hit.face;
    const normal = new Vector3();
    const bary = this.#barycentric(hit.point, a, b, c);
    const share = new Map();
    for (const [corner, part] of [[a, bary.x], [b, bary.y], [c, bary.z]]) {
      normal.addScaledVector(new Vector3().fromArray(this.coarse.normal, 3 * corner), part);
      for (let k = 0; k < 3; k++) {
        const site = this.coarse.sites[3 * corner + k];
        share.set(site, (share.get(site) ?? 0) + part * this.coarse.weights[3 * corner + k]);
      }
    }
    const [site] = [...share].reduce((best, entry) => (entry[1] > best[1] ? entry : best));
    return { point: hit.point, normal: normal.normalize(), site };
  }
  #barycentric(p, a, b, c) {
    const at = (v) => new Vector3().fromArray(this.coarse.position, 3 * v);
    const [A, B, C] = [at(a), at(b), at(c)];
    const area = new Vector3().crossVectors(B.clone().sub(A), C.clone().sub(A));
    const part = (x, y) => new Vector3().crossVectors(x.clone().sub(p), y.clone().sub(p)).dot(area) / area.lengthSq();
    return new Vector3(part(B, C), part(C, A), part(A, B));
  }

  /** Client pixels of a point of space. */
  project(point) {
    const p = new Vector3(...point).project(this.camera);
    const box = this.canvas.getBoundingClientRect();
    return [box.left + ((p.x + 1) / 2) * box.width, box.top + ((1 - p.y) / 2) * box.height];
  }

  dark(on) {
    this.material.uniforms.dark.value = on ? 1 : 0;
    this.sites.material.color = new Color(on ? 0xe8e6e0 : 0x1d2326);
    this.invalidate();
  }

  invalidate() {
    this.stale = true;
  }
  #render(ratio) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const pixels = [Math.floor(width * ratio), Math.floor(height * ratio)];
    if (this.canvas.width !== pixels[0] || this.canvas.height !== pixels[1]) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
    }
    this.renderer.render(this.scene, this.camera);
    this.frames++;
  }

  /** Draws where something changed, `now` (ms). Moving pictures have the resolution that this machine draws smoothly; a
   *  picture that rests is drawn at twice the display's resolution, which smooths its edges. */
  draw(now) {
    const { moving } = this;
    if (!this.stale) {
      if (moving.going && now - moving.last > STILL) {
        moving.going = false;
        this.#render(Math.min(2 * devicePixelRatio, 3));
      }
      return;
    }
    this.stale = false;
    if (moving.going) {
      moving.interval += 0.2 * (Math.min(now - moving.last, 200) - moving.interval);
      if (moving.interval > SLOW && moving.ratio > 0.35) [moving.ratio, moving.interval] = [0.85 * moving.ratio, 22];
      if (moving.interval < FAST && moving.ratio < devicePixelRatio) [moving.ratio, moving.interval] = [1.1 * moving.ratio, 22];
    }
    moving.going = true;
    moving.last = now;
    this.#render(moving.ratio);
  }
}

/** Pose whose z axis (tip to handle) is `axis`. */
export function poseAlong(point, axis, spin = 0) {
  const q = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), axis);
  q.multiply(new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), spin));
  return [point.x, point.y, point.z, q.w, q.x, q.y, q.z];
}

export { Matrix4, Vector3 };
