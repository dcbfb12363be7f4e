// SPDX-License-Identifier: GPL-3.0-or-later
// Motions of a spherical tip that keeps its orientation, one pose [x, y, z, w, x, y, z] a row, and the forces that
// `palpate play` gives along them.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { at } from "./folder.mjs";

/** Poses along straight lines between positions (m), at most `step` (m) apart. `palpate play` makes one tick a row of steps
 *  below a hundredth of the depth scale. */
function along(corners, step) {
  const rows = [[...corners[0], 1, 0, 0, 0]];
  for (const to of corners.slice(1)) {
    const from = rows.at(-1);
    const steps = Math.ceil(Math.hypot(...to.map((x, i) => x - from[i])) / step);
    for (let k = 1; k <= steps; k++) rows.push([...to.map((x, i) => from[i] + (k / steps) * (x - from[i])), 1, 0, 0, 0]);
  }
  return rows;
}

/** The block's tip is pressed 2 mm into the top, drawn across the groove, whose two flanks it overlaps at the bottom, up on
 *  the other side, and lifted. */
export function pressDragLift() {
  const top = 3e-3, bottom = 1e-3, above = 5.5e-3;
  return along([
    [0.002, -0.001, above], [0.002, -0.001, top], [-0.006, 0, top], [-0.012, 0.001, bottom], [-0.018, 0.002, top],
    [-0.02, 0.003, top], [-0.02, 0.003, above],
  ], 2e-5);
}

const add = (a, b, factor) => a.map((x, i) => x + factor * b[i]);
const less = (a, b) => add(a, b, -1);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const length = (a) => Math.hypot(...a);

/** The surface of an open file: {position, normal, near}: `near`, neighbours of each vertex. */
function surfaceOf(palp) {
  const triples = (list) => Array.from({ length: palp.vertexCount }, (_, v) => [...list.subarray(3 * v, 3 * v + 3)]);
  const position = triples(palp.positions()), normal = triples(palp.normals()), corners = palp.triangles();
  const near = position.map(() => new Set());
  for (let k = 0; k < corners.length; k++) {
    const first = k - (k % 3);
    for (let j = first; j < first + 3; j++) if (j !== k) near[corners[k]].add(corners[j]);
  }
  return { position, normal, near };
}

/** Distances (m) along edges from a vertex, and the vertex before each, as far as `reach` (m). */
function paths({ position, near }, from, reach) {
  const distance = new Map([[from, 0]]), before = new Map(), done = new Set();
  for (;;) {
    let next = -1;
    for (const [v, d] of distance) if (!done.has(v) && (next < 0 || d < distance.get(next))) next = v;
    if (next < 0) return { distance, before };
    done.add(next);
    for (const v of near[next]) {
      const d = distance.get(next) + length(less(position[v], position[next]));
      if (d > reach || d >= (distance.get(v) ?? Infinity)) continue;
      distance.set(v, d);
      before.set(v, next);
    }
  }
}

/** Angle (rad) by which the surface about a vertex is hollow: the mean slope of its edges above its tangential plane. */
function hollow({ position, normal, near }, v) {
  const slopes = [...near[v]].map((u) => less(position[u], position[v])).map((edge) => Math.asin(dot(edge, normal[v]) / length(edge)));
  return slopes.reduce((sum, slope) => sum + slope, 0) / slopes.length;
}

/** A tip of `radius` (m) is pressed `depth` (m) into the surface at `start`, drawn along edges through the most hollow
 *  vertex within 6 radii, on to the least hollow one ahead of it, and lifted. {rows, hollow: of the groove (rad)}. */
export function acrossGroove(palp, start, radius, depth) {
  const surface = surfaceOf(palp), { position, normal } = surface;
  const off = (v) => length(less(position[v], start));
  const first = position.reduce((best, _, v) => (off(v) < off(best) ? v : best), 0);
  const there = paths(surface, first, 6 * radius);
  const route = ({ before }, to) => (before.has(to) ? [...route({ before }, before.get(to)), to] : [to]);
  const centre = (v, deep) => add(position[v], normal[v], radius - deep);
  // A tip that is lifted out of a narrow place would press on its other wall.
  const clear = (at) => position.every((p) => length(less(p, at)) > 1.2 * radius);
  const byHollow = (vertices) => vertices.map((v) => [hollow(surface, v), v]).sort(([a], [b]) => b - a);
  for (const [depression, groove] of byHollow([...there.distance.keys()].filter((v) => there.distance.get(v) > radius))) {
    const onward = paths(surface, groove, 3 * radius), ahead = less(position[groove], position[first]);
    const beyond = [...onward.distance.keys()].filter((v) =>
      dot(less(position[v], position[groove]), ahead) > radius * length(ahead) && clear(centre(v, -radius)));
    if (!beyond.length) continue;
    const [, last] = byHollow(beyond).at(-1);
    const drawn = [...route(there, groove), ...route(onward, last).slice(1)].map((v) => centre(v, depth));
    return { rows: along([centre(first, -depth), ...drawn, centre(last, -radius)], 2e-5), hollow: depression };
  }
  throw new Error("no way leads across a hollow place");
}

/** A motion as `palpate play` reads it, a millisecond a row. */
export const motionText = (rows) =>
  "t,x,y,z,qw,qx,qy,qz\n" + rows.map((row, k) => [k / 1000, ...row].join(",")).join("\n") + "\n";

/** Rows that `palpate play --out` wrote: {force (N), state, depth (m)}. */
export function playedForces(name) {
  const [head, ...lines] = readFileSync(at(name), "utf8").trim().split("\n");
  assert.ok(head.startsWith("t,fx,fy,fz,tx,ty,tz,state,depth,"), head);
  return lines.map((line) => {
    const [, fx, fy, fz, , , , state, depth] = line.split(",");
    return { force: [fx, fy, fz].map(Number), state, depth: Number(depth) };
  });
}
