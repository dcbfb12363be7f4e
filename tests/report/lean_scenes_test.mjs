// SPDX-License-Identifier: GPL-3.0-or-later
// Leaner scenes have smaller files, faster ticks and shorter bakes: a frictionless liver with one tip, a liver with a
// tumour and two tools, a kidney with pyramids and a capsule that lies on it. Spacing and depth are the same, and only
// sites near the top are solved. PALPATE_FOLDER: folder to write to.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import test from "node:test";
import { at, folder, json, palpate, run } from "./folder.mjs";

const common = ["--tool-radius", "0.004", "--depth", "0.002", "--spacing", "0.018"];
const liver = ["liver", "--seed", "1", "--scale", "0.6", ...common];

function make(name, synth, tool = "") {
  palpate("synth", ...synth, "--out", name);
  const scene = at(`${name}/scene.toml`);
  const text = readFileSync(scene, "utf8").replace("[contact]", tool + "[contact]").replace("[sampling]", "[sampling]\nwithin_box = {min = [-0.014, -0.01, 0], max = [0.014, 0.01, 1]}");
  // Coarse solves: their number counts.
  writeFileSync(scene, text + "\n[response]\nmax_residual = 1000\npath_share = 0\n[solver]\nmesh_size = 0.6\ncheck_share = 0\n");
}

/** Costs of a scene; of the bake the processor's seconds, which other work on the machine does not change. */
function measure(name) {
  const out = run("bash", ["-c", '"$0" build "$1" --quiet --threads 1 --json > built.json && times', process.env.PALPATE, `${name}/scene.toml`]);
  const [, minutes, seconds] = out.trim().split("\n")[1].match(/^(\d+)m([\d.]+)s/);
  const { bake } = json("built.json");
  const bench = JSON.parse(palpate("bench", `${name}/scene.palp`, "--quiet", "--json", "--ticks", "10000"));
  const contents = JSON.parse(palpate("inspect", `${name}/scene.palp`, "--json"));
  const responses = contents.sections.find((section) => section.name === "RESPONSES");
  return {
    scene: name,
    features: contents.features.join(" "),
    tools: contents.tools.length,
    sites: contents.sites,
    responses_a_site: responses.count / contents.sites,
    bytes_a_site: responses.bytes / contents.sites,
    press_ns: bench.tick_ns.press.median,
    slide_ns: bench.tick_ns.slide.median,
    pairs: bake.pairs_planned,
    solves: bake.normal_solves + bake.tangential_solves,
    bake_s: 60 * minutes + Number(seconds),
    bake_s_a_site: (60 * minutes + Number(seconds)) / (bake.pairs_planned / (responses.count / contents.sites)),
  };
}

test("each scene costs more than the leaner one before it", (t) => {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  make("lean", [...liver, "--friction", "0"]);
  make("tumour", [...liver, "--tumour"], '[[tool]]\nname = "finger"\nshape = "sphere"\nradius = 0.006\n\n');
  make("kidney", ["kidney", "--scale", "0.6", ...common, "--tool", "capsule", "--tool-length", "0.01"]);
  const rows = ["lean", "tumour", "kidney"].map(measure);
  const columns = Object.keys(rows[0]);
  t.diagnostic("| " + columns.join(" | ") + " |");
  for (const row of rows) t.diagnostic("| " + columns.map((c) => (typeof row[c] === "number" ? Number(row[c].toPrecision(4)) : row[c])).join(" | ") + " |");
  for (let k = 1; k < rows.length; k++) {
    for (const cost of ["bytes_a_site", "press_ns", "bake_s_a_site"]) {
      assert.ok(rows[k - 1][cost] < rows[k][cost], `${cost}: ${rows[k - 1].scene} ${rows[k - 1][cost]}, ${rows[k].scene} ${rows[k][cost]}`);
    }
  }
});

test("build --report ends with the report", () => {
  const { report } = JSON.parse(palpate("build", "lean/scene.toml", "--report", "--json", "--quiet"));
  const { held_out, left_out } = json(report.numbers);
  assert.equal(held_out.figures, null);
  const friction = left_out.features.find((f) => f.name === "friction");
  assert.ok(!friction.present && friction.tick_ns > 0 && friction.slide_ns > 0, "friction would take no time");
  assert.equal(statSync(at(report.page)).size, report.page_bytes);
});
