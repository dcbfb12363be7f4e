// SPDX-License-Identifier: GPL-3.0-or-later
// Places of the tests' files, and the program that made them.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import path from "node:path";

const { PALPATE, PALPATE_FOLDER, PALPATE_PAGE_BUILD, PALPATE_PAGE_SOURCE, PALPATE_CHROMIUM } = process.env;
export const folder = PALPATE_FOLDER;
export const pageBuild = PALPATE_PAGE_BUILD;
export const pageSource = PALPATE_PAGE_SOURCE;
export const chromium = PALPATE_CHROMIUM?.endsWith("NOTFOUND") ? "" : PALPATE_CHROMIUM;

export const at = (name) => path.join(folder, name);
export const json = (name) => JSON.parse(readFileSync(at(name), "utf8"));
export const palpate = (...args) => execFileSync(PALPATE, args, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });

/** Poses [x, y, z, w, x, y, z] of a ball of this radius (m) on the plane z = 0: pressed in, drawn aside, lifted. Steps are
 *  below a hundredth of the depth scale, so that `palpate play` makes one tick a row. */
export function pressDragLift(radius, depth, aside) {
  const rows = [];
  const line = (from, to, steps) => {
    for (let k = 1; k <= steps; k++) rows.push([...from.map((x, i) => x + (k / steps) * (to[i] - x)), 1, 0, 0, 0]);
  };
  const above = [0.002, -0.001, radius + 0.0005], below = [0.002, -0.001, radius - depth], away = [0.002 + aside, -0.001 + aside / 3, radius - depth];
  rows.push([...above, 1, 0, 0, 0]);
  line(above, below, 150);
  line(below, away, 400);
  line(away, [away[0], away[1], above[2]], 150);
  return rows;
}

/** Forces of `palpate play` for such rows. */
export function played(rows, name) {
  const text = "t,x,y,z,qw,qx,qy,qz\n" + rows.map((row, k) => [k / 1000, ...row].join(",")).join("\n") + "\n";
  return { text, read: () => readFileSync(at(name), "utf8").trim().split("\n").slice(1).map((line) => {
    const [, fx, fy, fz, , , , state, depth] = line.split(",");
    return { force: [fx, fy, fz].map(Number), state, depth: Number(depth) };
  }) };
}
