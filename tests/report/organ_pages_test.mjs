// SPDX-License-Identifier: GPL-3.0-or-later
// Pages of whole organs in Chromium with software rendering: that of tools/demo.sh, and of the female liver where
// PALPATE_ORGANS names the folder with its file. PALPATE_FOLDER: folder to write to.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import test from "node:test";
import { drag, needChromium, openBrowser, openPage } from "./browser.mjs";
import { at, folder, json, pageBuild, pageSource, palpate } from "./folder.mjs";
import { acrossGroove, motionText, playedForces } from "./motion.mjs";
import { checkForces, checkHovering, checkNumbers, checkPlots, showOrgan } from "./page_checks.mjs";
import { takePicture } from "./picture.mjs";

needChromium();
const { Palp } = await import(path.join(pageSource, "page/palp.js"));
const organs = process.env.PALPATE_ORGANS;
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });

/** Draws ellipses with the tip pressed on the middle of the picture for six seconds: as `drag`. */
async function poke(page) {
  await showOrgan(page);
  const [x, y] = await page.evaluate(() => {
    const box = document.getElementById("canvas").getBoundingClientRect();
    return [box.left + box.width / 2, box.top + box.height / 2];
  });
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.waitForFunction(() => document.querySelector("#readout b")?.innerText.match(/[1-9]/), { timeout: 5000 });
  const rates = await drag(page, (s) => [x + 60 * Math.sin(2 * s), y + 25 * Math.cos(2 * s)], 6);
  await page.mouse.up();
  return rates;
}

/** Forces in the page of a scene along a press on a site, a drag across the most hollow place near it, and a lift. */
async function pressAcrossGroove(t, page, name, site, report) {
  const palp = await Palp.open(readFileSync(path.join(pageBuild, "poke.wasm")), readFileSync(at(`${name}.palp`)));
  const { depth_scale_m: scale, sites, tools } = report.organ;
  const { rows, hollow } = acrossGroove(palp, sites.position_m[site], tools[0].probe_radius_m, scale / 4);
  writeFileSync(at(`${name}.motion.csv`), motionText(rows));
  palpate("play", `${name}.palp`, `${name}.motion.csv`, "--out", `${name}.forces.csv`, "--quiet");
  const native = playedForces(`${name}.forces.csv`);
  await checkForces(page, rows, native);
  const touches = (row) => row.depth > 0;
  t.diagnostic(`${rows.length} scripted ticks across a place ${((180 / Math.PI) * hollow).toFixed(0)} degrees hollow: ` +
    `${[...new Set(native.map((row) => row.state))].join(", ")}; ` +
    `at most ${Math.max(...native.map((row) => Math.hypot(...row.force))).toFixed(2)} N`);
  assert.ok(hollow > 0, "no place near the site is hollow");
  assert.deepEqual([native[0].state, native.at(-1).state], ["free", "free"], "the tool comes and is lifted");
  const first = native.findIndex(touches), last = native.findLastIndex(touches);
  const touching = native.slice(first, last + 1).filter(touches).length / (last + 1 - first);
  assert.ok(touching > 0.95, `the tool touches in ${touching} of the drag`);
}

/** Every check on the page of a scene: {frames} a second, and names of its {plots}. `picture`: PNG to write; empty: none. */
async function checkPage(t, name, picture = "") {
  const report = json(`${name}.report.json`), file = at(`${name}.report.html`);
  const { browser, page, problems, requests } = await openBrowser();
  try {
    await openPage(page, "file://" + file);
    const megabytes = await checkNumbers(page, report, file);
    const plots = await checkPlots(page, report);
    const { site } = await checkHovering(page, report);
    await pressAcrossGroove(t, page, name, site, report);
    const { ticks, frames, resolution } = await poke(page);
    const triangles = await page.evaluate(() => palpateReport.view.geometry.index.count / 3);
    if (picture) await takePicture(page, at(picture));
    const load = os.loadavg()[0].toFixed(1);
    t.diagnostic(`plots: ${plots.join(", ")}; curves of site ${site}`);
    t.diagnostic(`${report.organ.sites.position_m.length} sites, ${triangles} triangles drawn, ${megabytes.toFixed(2)} MB: ` +
      `${frames.toFixed(1)} frames a second at ${resolution.toFixed(2)} of the resolution, ${ticks.toFixed(0)} ticks a second; load ${load}`);
    assert.deepEqual(problems, []);
    assert.deepEqual(requests, []);
    return { frames, plots };
  } finally {
    await browser.close();
  }
}

test("the page of the demo: numbers, plots, curves, forces, and 30 frames a second", async (t) => {
  const demo = ["--seed", "1", "--scale", "0.6", "--young", "25000", "--tool-radius", "0.006", "--depth", "0.004", "--spacing", "0"];
  palpate("synth", "liver", "--out", "demo", ...demo, "--quiet");
  palpate("build", "demo/scene.toml", "--quiet");
  palpate("verify", "demo/scene.toml", "--count", "10", "--report", "demo/verify.json", "--quiet");
  palpate("report", "demo/scene.toml", "--verify", "demo/verify.json", "--run", "demo/motion.csv", "--quiet");
  const { frames, plots } = await checkPage(t, "demo/scene", "demo/report.png");
  for (const plot of ["held-out", "error-force_ns-laws", "error-tick_ns-files"]) assert.ok(plots.includes(plot), plot);
  assert.ok(frames >= 30, `${frames} frames a second`);
});

test("the page of the female liver: numbers, plots, curves, forces", { skip: !organs && "PALPATE_ORGANS names no folder" }, async (t) => {
  // All of the liver is touchable; its contacts near the middle are solved, coarsely.
  writeFileSync(at("liver.toml"), `[body]
surface = "${organs}/VH_F_Liver.glb"
[[tool]]
radius = 0.006
[contact]
friction = 0
[sampling]
spacing = 0.012
depth = 0.004
within_box = {min = [-0.06, 0.28, -0.2], max = [-0.03, 0.31, 0]}
[response]
max_residual = 1000
[solver]
mesh_size = 0.7
check_share = 0
`);
  palpate("build", "liver.toml", "--quiet");
  palpate("verify", "liver.toml", "--count", "5", "--report", "verify.json", "--quiet");
  palpate("report", "liver.toml", "--verify", "verify.json", "--quick", "--quiet");
  const { plots } = await checkPage(t, "liver");
  assert.ok(plots.includes("held-out"));
});
