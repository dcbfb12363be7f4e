// SPDX-License-Identifier: GPL-3.0-or-later
// Leaner scenes have smaller files, faster ticks and shorter bakes: a frictionless liver with one tip, a liver with a
// tumour and two tools, a kidney with pyramids and a capsule that lies on it, at one spacing and depth. PALPATE_SCENES: where to.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

const folder = process.env.PALPATE_SCENES;
const palpate = (...args) => execFileSync(process.env.PALPATE, args, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
const common = ["--tool-radius", "0.004", "--depth", "0.002", "--spacing", "0.018"];
const liver = ["liver", "--seed", "1", "--scale", "0.6", ...common];

function add(name, from, text) {
  const scene = path.join(folder, name, "scene.toml");
  writeFileSync(scene, readFileSync(scene, "utf8").replace(from, text));
}

function measure(name) {
  const built = JSON.parse(palpate("build", `${name}/scene.toml`, "--quiet", "--json"));
  const bench = JSON.parse(palpate("bench", `${name}/scene.palp`, "--quiet", "--json"));
  const inspected = JSON.parse(palpate("inspect", `${name}/scene.palp`, "--json"));
  const responses = inspected.sections.find((s) => s.name === "RESPONSES");
  return {
    scene: name,
    sites: inspected.sites,
    responses: responses.count,
    response_bytes: responses.bytes,
    bytes_per_site: responses.bytes / inspected.sites,
    tick_ns: bench.tick_ns.press.median,
    slide_ns: bench.tick_ns.slide.median,
    solves: built.bake.normal_solves + built.bake.tangential_solves,
    bake_seconds: built.bake.bake_seconds,
    seconds_per_site: built.bake.bake_seconds / built.bake.pairs_planned * (responses.count / inspected.sites),
  };
}

test("each scene costs more than the leaner one before it", (t) => {
  mkdirSync(folder, { recursive: true });
  palpate("synth", ...liver, "--friction", "0", "--out", "lean");
  palpate("synth", ...liver, "--tumour", "--out", "tumour");
  add("tumour", "[contact]", '[[tool]]\nname = "finger"\nshape = "sphere"\nradius = 0.006\n\n[contact]');
  palpate("synth", "kidney", "--scale", "0.6", ...common, "--tool", "capsule", "--tool-length", "0.01", "--out", "kidney");
  const rows = ["lean", "tumour", "kidney"].map(measure);
  t.diagnostic(JSON.stringify(rows, null, 1));
  for (let k = 1; k < rows.length; k++) {
    for (const cost of ["bytes_per_site", "tick_ns", "seconds_per_site"]) {
      assert.ok(rows[k - 1][cost] < rows[k][cost], `${cost}: ${rows[k - 1].scene} ${rows[k - 1][cost]}, ${rows[k].scene} ${rows[k][cost]}`);
    }
  }
});
