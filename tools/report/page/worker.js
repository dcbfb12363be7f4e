// SPDX-License-Identifier: GPL-3.0-or-later
// The force loop: one tick a millisecond while a tool is held. A browser wakes a worker every few milliseconds; the ticks
// that are due are then made one after the other, on the way from the last pose to the newest target.
import { Palp } from "./palp.js";

const PERIOD = 1e-3; // s
const FASTEST = 0.25; // m/s that the held tool follows its target with
const LONGEST = 100; // ticks at once; what is beyond is skipped

let palp;
let pose = null; // of the last tick
let target = null;
let timer = null;
let due = 0; // ms
let ticks = 0;

function towards(from, to) {
  const way = Math.hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  const share = way > 0 ? Math.min(1, (FASTEST * PERIOD) / way) : 1;
  const next = from.map((x, k) => x + share * (to[k] - x));
  const cosine = from[3] * to[3] + from[4] * to[4] + from[5] * to[5] + from[6] * to[6];
  for (let k = 3; k < 7; k++) next[k] = from[k] + share * ((cosine < 0 ? -to[k] : to[k]) - from[k]);
  const norm = Math.hypot(next[3], next[4], next[5], next[6]);
  for (let k = 3; k < 7; k++) next[k] /= norm;
  return next;
}

function wake() {
  const now = performance.now();
  let steps = Math.floor((now - due) / (1e3 * PERIOD));
  if (steps <= 0) return;
  due += steps * 1e3 * PERIOD;
  steps = Math.min(steps, LONGEST);
  const forces = new Float32Array(2 * steps);
  let last;
  for (let k = 0; k < steps; k++) {
    pose = towards(pose, target);
    last = palp.tick(pose);
    ticks++;
    const normal = last.force[0] * last.normal[0] + last.force[1] * last.normal[1] + last.force[2] * last.normal[2];
    forces[2 * k] = normal;
    forces[2 * k + 1] = Math.sqrt(Math.max(0, last.force[0] ** 2 + last.force[1] ** 2 + last.force[2] ** 2 - normal ** 2));
  }
  postMessage({ type: "ticks", forces, tick: last, pose, ticks, period: (performance.now() - now) / steps }, [forces.buffer]);
}

const actions = {
  async open({ wasm, file }) {
    palp = await Palp.open(wasm, file);
    postMessage({ type: "open" });
  },
  tool({ tool }) {
    palp.takeTool(tool);
  },
  /** From a pose outside the body on. */
  hold({ from, to }) {
    pose = from;
    target = to;
    due = performance.now();
    palp.tick(pose);
    timer ??= setInterval(wake, 1);
  },
  move({ to }) {
    target = to;
  },
  release() {
    clearInterval(timer);
    timer = null;
  },
  /** One tick a row, from a fresh contact. */
  script({ id, tool, rows }) {
    palp.takeTool(tool);
    postMessage({ type: "script", id, ticks: rows.map((row) => palp.tick(row)) });
  },
};

// In the order of arrival: opening takes a while.
let before = Promise.resolve();
onmessage = ({ data }) => (before = before.then(() => actions[data.type](data)));
