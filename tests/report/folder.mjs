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

/** Poses [x, y, z, w, x, y, z] of the block's tip (m): pressed 2 mm into the top, drawn across the groove, whose two flanks
 *  it overlaps at the bottom, up on the other side, lifted. Steps are below a hundredth of the depth scale, so that
 *  `palpate play` makes one tick a row. */
export function pressDragLift() {
  const step = 2e-5, top = 3e-3, bottom = 1e-3, above = 5.5e-3;
  const corners = [
    [0.002, -0.001, above], [0.002, -0.001, top], [-0.006, 0, top], [-0.012, 0.001, bottom], [-0.018, 0.002, top],
    [-0.02, 0.003, top], [-0.02, 0.003, above],
  ];
  const rows = [[...corners[0], 1, 0, 0, 0]];
  for (const to of corners.slice(1)) {
    const from = rows.at(-1);
    const steps = Math.ceil(Math.hypot(...to.map((x, i) => x - from[i])) / step);
    for (let k = 1; k <= steps; k++) rows.push([...to.map((x, i) => from[i] + (k / steps) * (x - from[i])), 1, 0, 0, 0]);
  }
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
