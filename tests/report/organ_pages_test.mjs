// SPDX-License-Identifier: GPL-3.0-or-later
// Pages of whole organs in Chromium with software rendering: that of tools/demo.sh, and of the female liver where
// PALPATE_ORGANS names the folder with its file. PALPATE_SCENES: folder to write to.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import test from "node:test";
import { drag, needChromium, openBrowser, openPage } from "./browser.mjs";

needChromium();
const { PALPATE, PALPATE_SCENES: folder, PALPATE_ORGANS: organs } = process.env;
const palpate = (...args) => execFileSync(PALPATE, [...args, "--quiet"], { cwd: folder, stdio: ["ignore", "pipe", "pipe"] });
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });

/** Opens the page of a scene, presses on the middle of its picture, and draws ellipses there for six seconds. */
async function poked(t, scene) {
  const name = path.join(folder, scene.replace(".toml", ".report"));
  const { organ } = JSON.parse(readFileSync(name + ".json", "utf8"));
  const megabytes = statSync(name + ".html").size / 1e6;
  assert.ok(megabytes <= 3, `${megabytes} MB`);
  const { browser, page, problems, requests } = await openBrowser();
  try {
    await openPage(page, "file://" + name + ".html");
    await page.evaluate(() => document.getElementById("canvas").scrollIntoView({ block: "center" }));
    const [x, y] = await page.evaluate(() => {
      const box = document.getElementById("canvas").getBoundingClientRect();
      return [box.left + box.width / 2, box.top + box.height / 2];
    });
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.waitForFunction(() => document.querySelector("#readout b")?.innerText.match(/[1-9]/), { timeout: 5000 });
    const { ticks, frames, resolution } = await drag(page, (s) => [x + 60 * Math.sin(2 * s), y + 25 * Math.cos(2 * s)], 6);
    await page.mouse.up();
    const triangles = await page.evaluate(() => palpateReport.view.geometry.index.count / 3);
    const load = os.loadavg()[0].toFixed(1);
    t.diagnostic(`${organ.sites.position_m.length} sites, ${triangles} triangles drawn, ${megabytes.toFixed(2)} MB: ` +
      `${frames.toFixed(1)} frames a second at ${resolution.toFixed(2)} of the resolution, ${ticks.toFixed(0)} ticks a second; load ${load}`);
    assert.deepEqual(problems, []);
    assert.deepEqual(requests, []);
    return frames;
  } finally {
    await browser.close();
  }
}

test("the page of the demo draws 30 frames a second", async (t) => {
  const demo = ["--seed", "1", "--scale", "0.6", "--young", "25000", "--tool-radius", "0.006", "--depth", "0.004", "--spacing", "0"];
  palpate("synth", "liver", "--out", "demo", ...demo);
  palpate("build", "demo/scene.toml");
  palpate("verify", "demo/scene.toml", "--count", "10", "--report", "demo/verify.json");
  palpate("report", "demo/scene.toml", "--verify", "demo/verify.json", "--run", "demo/motion.csv");
  const frames = await poked(t, "demo/scene.toml");
  assert.ok(frames >= 30, `${frames} frames a second`);
});

test("the page of the female liver opens without error and request", { skip: !organs && "PALPATE_ORGANS names no folder" }, async (t) => {
  // All of the liver is touchable; its contacts near the middle are solved, coarsely.
  writeFileSync(path.join(folder, "liver.toml"), `[body]
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
  palpate("build", "liver.toml");
  palpate("report", "liver.toml", "--quick");
  await poked(t, "liver.toml");
});
