// SPDX-License-Identifier: GPL-3.0-or-later
// Pressing on the organ: pointer to pose of the tool, force loop in a worker, read-outs.
import workerText from "worker:text";
import { poseAlong, Vector3 } from "./organ.js";
import { STATES } from "./palp.js";
import { number } from "./format.js";

const TILT = 0.12; // rad a notch of the wheel
const MOST_TILT = 0.9; // rad

export class Poke {
  /** `elements`: readout, trace, depth, depthText, tool. */
  constructor(view, organ, wasm, file, elements) {
    Object.assign(this, { view, organ, elements });
    this.worker = new Worker(URL.createObjectURL(new Blob([workerText], { type: "text/javascript" })));
    this.worker.onmessage = ({ data }) => this[`on_${data.type}`](data);
    this.ready = new Promise((resolve) => (this.on_open = resolve));
    this.worker.postMessage({ type: "open", wasm, file });
    this.scripts = new Map();
    this.history = [];
    this.tilt = 0;
    this.tool = 0;
    // The arrow of the largest force at the fields' depth is as long as half of the organ.
    const forces = organ.tools.flatMap((t) => t.force_N).sort((a, b) => a - b);
    this.newtonsPerRadius = 2 * forces[Math.floor(0.95 * (forces.length - 1))] || 1;
    this.#listen();
    this.trace();
  }

  takeTool(index) {
    this.release();
    this.tool = index;
    this.view.takeTool(index);
    this.worker.postMessage({ type: "tool", tool: index });
  }

  depth() {
    return Number(this.elements.depth.value) * this.organ.depth_scale_m;
  }

  /** Pose of the tool pressed `depth` (m) into a point of the surface; negative: above it. */
  pose(hit, depth) {
    const tool = this.organ.tools[this.tool];
    const axis = hit.normal.clone();
    if (this.tilt) axis.applyAxisAngle(this.#tiltAxis(hit.normal), this.tilt);
    const skin = tool.probe_radius_m;
    return poseAlong(hit.point.clone().addScaledVector(hit.normal, skin - depth), axis);
  }
  #tiltAxis(normal) {
    const across = new Vector3().setFromMatrixColumn(this.view.camera.matrixWorld, 2).cross(normal);
    return across.lengthSq() > 1e-9 ? across.normalize() : new Vector3(1, 0, 0).cross(normal).normalize();
  }

  #listen() {
    const { canvas } = this.view;
    canvas.addEventListener("pointerdown", (event) => {
      const hit = event.button === 0 && event.isPrimary ? this.view.pick(event.clientX, event.clientY) : null;
      this.view.controls.enabled = !hit;
      if (!hit) return;
      canvas.setPointerCapture(event.pointerId);
      this.hold(hit);
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (!this.held) return;
      const hit = this.view.pick(event.clientX, event.clientY);
      if (hit) this.move(hit);
    });
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, () => {
        this.release();
        this.view.controls.enabled = true;
      });
    }
    canvas.addEventListener("wheel", (event) => {
      if (!this.held) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      this.tilt = Math.min(Math.max(this.tilt + Math.sign(event.deltaY) * TILT, -MOST_TILT), MOST_TILT);
      this.move(this.held);
    }, { capture: true, passive: false });
    this.elements.depth.addEventListener("input", () => this.held && this.move(this.held));
  }

  hold(hit) {
    this.held = hit;
    const clear = 0.3 * this.organ.depth_scale_m;
    this.worker.postMessage({ type: "tool", tool: this.tool });
    this.worker.postMessage({ type: "hold", from: this.pose(hit, -clear), to: this.pose(hit, this.depth()) });
  }
  move(hit) {
    this.held = hit;
    this.worker.postMessage({ type: "move", to: this.pose(hit, this.depth()) });
  }
  release() {
    if (!this.held) return;
    this.held = null;
    this.tilt = 0;
    this.worker.postMessage({ type: "release" });
    this.latest = null;
    this.view.show(null);
    this.#read(null);
  }

  on_ticks({ forces, tick, pose, ticks, period }) {
    for (let k = 0; k < forces.length; k += 2) this.history.push([forces[k], forces[k + 1]]);
    this.history.splice(0, Math.max(0, this.history.length - 3000));
    this.period = period;
    this.ticks = ticks;
    if (!this.held) return;
    this.latest = { tick, pose };
  }
  on_script({ id, ticks }) {
    this.scripts.get(id)(ticks);
    this.scripts.delete(id);
  }

  /** Ticks of a fresh contact, one a row [x, y, z, w, x, y, z]. */
  script(tool, rows) {
    const id = this.scripts.size;
    return new Promise((resolve) => {
      this.scripts.set(id, resolve);
      this.worker.postMessage({ type: "script", id, tool, rows });
    });
  }

  /** Once a frame. */
  draw() {
    if (!this.latest) return;
    const { tick, pose } = this.latest;
    this.latest = null;
    this.view.show(pose, tick, this.newtonsPerRadius);
    this.#read(tick);
    this.trace();
  }

  #read(tick) {
    const { readout } = this.elements;
    if (!tick) {
      readout.replaceChildren();
      return;
    }
    const force = Math.hypot(...tick.force);
    const normal = tick.force.reduce((sum, f, k) => sum + f * tick.normal[k], 0);
    const across = Math.sqrt(Math.max(0, force ** 2 - normal ** 2));
    const state = STATES[tick.state];
    const limit = Number.isFinite(tick.frictionLimit) && tick.frictionLimit > 0 ? `, friction limit ${number(tick.frictionLimit, 2)} N` : "";
    const warn = tick.extrapolated ? "deeper than was sampled" : tick.filledShare > 0.5 ? "filled from neighbours" : "";
    readout.innerHTML = `<b>${number(force)} N</b><span class="state-${state}">${state}</span>, ${number(1e3 * tick.depth)} mm deep<br>tangential ${number(across, 2)} N${limit}<br>${warn}`;
  }

  trace() {
    const { trace } = this.elements;
    const context = trace.getContext("2d");
    const ratio = Math.min(devicePixelRatio, 2);
    const width = trace.clientWidth, height = trace.clientHeight;
    if (trace.width !== width * ratio) [trace.width, trace.height] = [width * ratio, height * ratio];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const style = getComputedStyle(document.documentElement);
    const shown = 3000, left = 34, bottom = 14;
    const most = Math.max(1e-9, ...this.history.map(([a, b]) => Math.max(a, b)));
    const unit = 10 ** Math.floor(Math.log10(most));
    const top = [1, 2, 5, 10].map((k) => k * unit).find((x) => x >= most * 0.999);
    const x = (k) => left + ((shown - this.history.length + k) / shown) * (width - left);
    const y = (f) => 8 + (1 - f / top) * (height - bottom - 8);
    context.font = "10px system-ui, sans-serif";
    context.fillStyle = style.getPropertyValue("--soft");
    context.strokeStyle = style.getPropertyValue("--faint");
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const f of [0, top / 2, top]) {
      context.beginPath();
      context.moveTo(left, y(f));
      context.lineTo(width, y(f));
      context.stroke();
      if (this.history.length) context.fillText(number(f, 2), left - 4, y(f));
    }
    context.textBaseline = "alphabetic";
    context.fillText("now", width, height - 2);
    context.textAlign = "left";
    context.fillText("3 s ago", left, height - 2);
    for (const [part, colour] of [[0, "--accent"], [1, "--warm"]]) {
      context.beginPath();
      context.strokeStyle = style.getPropertyValue(colour);
      context.lineWidth = 1.5;
      const step = Math.max(1, Math.floor(shown / (2 * width)));
      for (let k = 0; k < this.history.length; k += step) context.lineTo(x(k), y(this.history[k][part]));
      context.stroke();
      context.lineWidth = 1;
    }
  }
}
