// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of the report, each recomputed another way.
import assert from "node:assert/strict";
import { readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import test from "node:test";
import { at, json, palpate } from "./folder.mjs";

const report = json("scene.report.json");
const near = (a, b, relative = 1e-4) => assert.ok(Math.abs(a - b) <= relative * Math.abs(b), `${a} instead of ${b}`);

/** Quantile by linear interpolation between order statistics. */
function quantile(values, q) {
  const sorted = [...values].sort((a, b) => a - b);
  const at = q * (sorted.length - 1), k = Math.floor(at);
  return k + 1 < sorted.length ? sorted[k] + (at - k) * (sorted[k + 1] - sorted[k]) : sorted[k];
}

test("held-out errors are those of the solved and baked forces of verify", () => {
  const errors = [];
  for (const contact of json("verify.json").held_out) {
    const length = (v) => Math.hypot(...v);
    const peak = Math.max(...contact.forces.map((f) => length(f.solved_N)));
    for (const f of contact.forces.filter((f) => f.kind === "normal")) {
      errors.push(length(f.baked_N.map((b, k) => b - f.solved_N[k])) / Math.max(length(f.solved_N), 0.02 * peak));
    }
  }
  const { error } = report.error_time.files[0];
  assert.equal(report.held_out.command, "palpate verify scene.toml --count 3 --seed 1 --report verify.json");
  assert.equal(error.count, errors.length);
  near(error.median, quantile(errors, 0.5));
  near(error.p95, quantile(errors, 0.95));
  near(error.worst, Math.max(...errors));
});

test("bytes of a file and of a response are those on disk", () => {
  const [own] = report.error_time.files;
  const bytes = readFileSync(at("scene.palp"));
  assert.equal(own.bytes, statSync(at("scene.palp")).size);
  const sections = bytes.readUInt32LE(12);
  let size = 0;
  for (let k = 0; k < sections; k++) if (bytes.readUInt32LE(64 + 32 * k) === 9) size = bytes.readUInt32LE(64 + 32 * k + 4);
  assert.equal(own.bytes_per_response, size);
});

test("the stiffness of a site is the slope of its exported curve", () => {
  palpate("export", "scene.palp", "--curves", "curves.csv", "--points", "2001");
  const rows = readFileSync(at("curves.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
  const [site, kind, depth, force] = ["site", "kind", "depth_m", "force_normal_N"].map((name) => rows[0].indexOf(name));
  const solved = report.organ.tools[0].source.indexOf("solved");
  const curve = rows.filter((row) => row[site] === String(solved) && row[kind] === "normal").map((row) => [Number(row[depth]), Number(row[force])]);
  const k = curve.findIndex(([d]) => d >= report.organ.field_depth_m);
  near(report.organ.tools[0].stiffness_N_per_m[solved], (curve[k + 1][1] - curve[k - 1][1]) / (curve[k + 1][0] - curve[k - 1][0]), 2e-3);
  near(report.organ.tools[0].force_N[solved], curve[k][1], 5e-3);
});

test("a scene beside this one has the errors of its own file at the same contacts", () => {
  const coarse = readFileSync(at("scene.toml"), "utf8").replace(/spacing = .*/g, "spacing = 0.04");
  writeFileSync(at("coarse.toml"), coarse);
  rmSync(at("coarse.work"), { recursive: true, force: true });  // of an earlier program
  palpate("build", "coarse.toml", "--quiet");
  const files = ["--quick", "--quiet", "--contacts", "2", "--numbers", "beside.json", "--page", "beside.html"];
  palpate("report", "scene.toml", "--verify", "verify.json", "--beside", "coarse.toml", ...files);
  const { error_time, provenance, command } = json("beside.json");
  assert.equal(command, "palpate report scene.toml --verify verify.json --beside coarse.toml --contacts 2 --quick");
  assert.deepEqual(error_time.files.map((file) => file.label), ["this file", "spacing 40 mm"]);
  const [own, other] = error_time.files;
  assert.equal(other.bytes, statSync(at("coarse.palp")).size);
  near(other.bake_hours, json("coarse.work/bake.json").seconds / 3600);
  const recomputed = JSON.parse(palpate("verify", "coarse.palp", "--samples", "verify.json", "--json", "--quiet")).error;
  assert.equal(other.error.count, own.error.count);
  near(other.error.p95, recomputed.p95);
  near(other.error.worst, recomputed.worst.error);
  assert.ok(other.sites < own.sites && other.error.median > own.error.median);
  assert.ok(provenance.inputs.some((input) => input.file === "coarse.toml"));
  assert.throws(() => palpate("report", "scene.toml", "--beside", "coarse.toml", ...files), /--verify/);
  assert.throws(() => palpate("report", "scene.toml", "--verify", "verify.json", "--beside", "none.toml", ...files), /none\.toml/);
});

test("the bake's time is that of its account", () => near(report.error_time.files[0].bake_hours, json("scene.work/bake.json").seconds / 3600));

test("contacts and equilibria are those that build counts", () => {
  const built = JSON.parse(palpate("build", "scene.toml", "--json", "--quiet")).bake;
  const { bake } = report.stability;
  assert.equal(bake.planned, built.pairs_planned);
  assert.equal(bake.accepted, built.pairs_accepted);
  assert.equal(bake.solves, built.normal_solves + built.tangential_solves);
  // A shallow push whose contact the mesh does not resolve has no place on its curve.
  const depths = report.curves.pairs.map((pair) => pair.normal_m_N.map(([depth]) => depth));
  const all = depths.find((each) => each.length === 6);
  for (const each of depths) each.forEach((depth, k) => near(depth, all.at(k - each.length), 0.02));
  assert.equal(built.normal_solves, 6 * depths.length);
  const solves = Object.fromEntries(report.left_out.features.map((f) => [f.name, f.solves]));
  assert.equal(solves.friction, built.pairs_planned * 2 * 4 * 2);
  assert.equal(solves.slip_softening, built.pairs_planned * 2 * 3 * 3);
  // Seven depths; from three of them, moves along the directions, or three turns both ways.
  assert.equal(solves.bonded, built.pairs_planned * (7 + 3 * 4 * 2));
  assert.equal(solves.bonded_torque, built.pairs_planned * 3 * 6);
});

test("each feature has its time, or says why there is none", () => {
  const features = Object.fromEntries(report.left_out.features.map((f) => [f.name, f]));
  for (const name of ["tangential_bias", "friction", "slip_softening", "search"]) {
    const { tick_ns, slide_ns, cause } = features[name];
    assert.ok(Number.isFinite(tick_ns) && Number.isFinite(slide_ns) && cause === undefined, name);
  }
  assert.ok(features.search.slide_ns < 0, "a search tree makes a slide slower");
  for (const name of ["tool_patches", "bonded", "bonded_torque", "spin", "compliance"]) {
    assert.match(features[name].cause, /palpate bench|no tick/, name);
    assert.equal(features[name].tick_ns, undefined);
  }
  assert.equal(features.bonded.bytes, features.bonded.bytes_per_response * report.contents.responses);
  for (const name of ["tool_patches", "spin", "compliance"]) assert.deepEqual([features[name].bytes, features[name].solves], [null, null]);
});

test("the run is that of play", () => {
  const forces = readFileSync(at("forces.csv"), "utf8").trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
  assert.equal(report.run.rows, forces.length);
  const { force_N, time_s } = report.run;
  const row = (time) => forces.find((f) => Math.abs(f[0] - time) < 1e-9);
  for (let k = 0; k < time_s.length; k += 50) {
    const native = row(time_s[k]);
    for (let i = 0; i < 3; i++) assert.ok(Math.abs(force_N[k][i] - native[i + 1]) <= 1e-4 * Math.abs(native[i + 1]) + 1e-12);
  }
});

test("every section names the command of its figures", () => {
  for (const part of [report, report.organ, report.contents, report.curves, report.held_out, report.error_time, report.stability.bake, report.left_out, report.run, report.provenance]) {
    assert.match(part.command, /^palpate /);
  }
  assert.match(report.stability.battery_command, /^palpate /);
  assert.match(report.stability.devices_command, /^palpate /);
});

test("the files and models lie on the plots' axes", () => {
  assert.ok(report.error_time.files.length > 1);
  const models = report.error_time.laws.map((law) => law.model);
  for (const model of ["quadratic potential", "linear spring", "separable"]) assert.ok(models.includes(model), model);
  assert.ok(report.error_time.solve.ns > 1e3 * report.error_time.files[0].tick_ns);
});

test("cells of the battery are judged, and those near the scene are marked", () => {
  const { cells } = report.stability.battery;
  assert.deepEqual(cells.map((cell) => cell.result), ["verified", "wrong", "converged", "refused"]);
  // The scene: 5 kPa, 0.45, 0.6 radii deep.
  assert.deepEqual(cells.map((cell) => cell.near), [true, false, false, false]);
  assert.deepEqual(cells.map((cell) => cell.young_Pa), [1e3, 1e9, 1e3, 1e3]);
  assert.deepEqual(cells.map((cell) => cell.depth_over_radius), [1, 1, 1, 0.2]);
  assert.throws(() => palpate("report", "scene.toml", "--battery", "verify.json", "--quick", "--quiet", "--numbers", "n.json", "--page", "n.html"), /no report of palpate verify --battery/);
});

test("wrong inputs are refused with their cause", () => {
  const report = (...args) => palpate("report", "scene.toml", "--quick", "--quiet", ...args);
  assert.throws(() => report("--verify", "scene.toml"), /scene\.toml/);
  assert.throws(() => report("--compare", "verify.json"), /verify\.json/);
  assert.throws(() => report("--page", "verify.json", "--verify", "verify.json"), /verify\.json/);
  assert.throws(() => report("--numbers", "scene.palp"), /scene\.palp/);
});
