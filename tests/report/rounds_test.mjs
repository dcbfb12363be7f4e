// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a scene with automatic sampling: its plan has later rounds than the first, and hidden pushes without a site.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { at, json, palpate } from "./folder.mjs";

test("the report has the sites of the last round, and no hidden push among them", () => {
  rmSync(at("rounds"), { recursive: true, force: true });
  mkdirSync(at("rounds"));
  const scene = readFileSync(at("scene.toml"), "utf8").replace(/^(margin_)?spacing = .*\n/gm, "")
    // Fewer solves a site, on a coarser mesh.
    .replace(/^friction = .*/m, "friction = 0").replace(/^normal_points = .*/m, "normal_points = 4")
    .replace("growth = 1", "growth = 1\nmax_size = 0.03").replace("path_share = 0", "path_share = 0\ntolerance = 0.01")
    .replace(/^surface = .*/m, `surface = "${fileURLToPath(new URL("../bakes/slab.obj", import.meta.url))}"`);  // fewer rounds than the groove
  writeFileSync(at("rounds/scene.toml"), scene.replace("[sampling]", "[sampling]\nmost_sites = 190"));
  try {
    palpate("build", "rounds/scene.toml", "--quiet");
  } catch (error) {
    assert.equal(error.status, 5, error.stderr);  // 190 sites are too few for 1 %
  }
  palpate("report", "rounds/scene.toml", "--quick", "--contacts", "2", "--quiet");
  const report = json("rounds/scene.report.json"), first = json("rounds/scene.work/manifest.json");
  const sites = report.organ.sites.position_m.length, solved = report.organ.tools[0].error_solve;
  const planned = new Set([...first.pairs.filter((pair) => pair.role !== "hidden"), ...first.skipped].map((pair) => pair.site));
  assert.ok(sites > planned.size, `${sites} sites: the first round's`);
  assert.equal(solved.length, sites);
  const accepted = new Set(report.curves.pairs.filter((pair) => !pair.refused).map((pair) => pair.site));
  solved.forEach((error, site) => assert.equal(error !== null, accepted.has(site), `site ${site}`));
  assert.ok(solved.filter((error) => error !== null).length > 8);
});
