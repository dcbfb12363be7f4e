// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime as WebAssembly gives the forces of the native runtime.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";
import { at, json, pageBuild, pageSource } from "./folder.mjs";
import { playedForces, pressDragLift } from "./motion.mjs";

const { fromPlanes, Palp, STATES } = await import(path.join(pageSource, "page/palp.js"));
const wasm = readFileSync(path.join(pageBuild, "poke.wasm"));
const file = readFileSync(at("scene.palp"));

test("the module imports nothing", () => assert.deepEqual(WebAssembly.Module.imports(new WebAssembly.Module(wasm)), []));

test("a press, a drag across a groove and a lift have the native forces within 1e-6", async () => {
  const palp = await Palp.open(wasm, file);
  const rows = pressDragLift();
  const native = playedForces("forces.csv");
  assert.equal(native.length, rows.length);
  const peak = Math.max(...native.map((row) => Math.hypot(...row.force)));
  assert.ok(peak > 0.01);
  const states = new Set(), flanks = new Set();
  palp.takeTool(0);
  rows.forEach((row, k) => {
    const tick = palp.tick(row);
    states.add(STATES[tick.state]);
    if (Math.abs(tick.normal[0]) > 0.3) flanks.add(Math.sign(tick.normal[0]));
    assert.equal(STATES[tick.state], native[k].state, `row ${k}`);
    const off = Math.hypot(...tick.force.map((f, i) => f - native[k].force[i]));
    const size = Math.hypot(...native[k].force);
    // Below a millionth of the peak the printed digits of the native force end.
    assert.ok(off <= 1e-6 * Math.max(size, 1e-3 * peak), `row ${k}: ${tick.force} instead of ${native[k].force}`);
  });
  for (const state of ["free", "stick", "slide", "released"]) assert.ok(states.has(state), state);
  assert.deepEqual([...flanks], [-1, 1], "the tool touches one flank of the groove, then the other");
});

test("curves are those of palpate export", async () => {
  const palp = await Palp.open(wasm, file);
  const organ = json("scene.report.json").organ;
  const [pair] = json("scene.report.json").curves.pairs;
  const depths = Float32Array.from(pair.normal_m_N.map(([depth]) => depth));
  const baked = palp.normalForces(pair.site, pair.tool_vertex, depths);
  const peak = Math.max(...pair.normal_m_N.map(([, force]) => force));
  pair.normal_m_N.forEach(([, force], k) => assert.ok(Math.abs(baked[k] - force) < 0.05 * peak, `depth ${depths[k]}`));
  const [half] = palp.normalForces(pair.site, 0, Float32Array.of(organ.field_depth_m));
  assert.ok(Math.abs(half - organ.tools[0].force_N[pair.site]) < 1e-4 * half);
});

test("a damaged file is refused with its fault", async () => {
  const damaged = Uint8Array.from(file);
  damaged[200] ^= 1;
  await assert.rejects(Palp.open(wasm, damaged), /checksum/i);
});

test("weights of a vertex's sites sum to one", async () => {
  const palp = await Palp.open(wasm, file);
  const weights = palp.vertexWeights();
  for (let v = 0; v < palp.vertexCount; v++) assert.ok(Math.abs(weights[3 * v] + weights[3 * v + 1] + weights[3 * v + 2] - 1) < 1e-6);
});

test("planes are put back in order", () => {
  const bytes = Uint8Array.from({ length: 11 }, (_, k) => k);
  const planes = Uint8Array.from([0, 4, 8, 1, 5, 9, 2, 6, 10, 3, 7]);
  assert.deepEqual(fromPlanes(planes), bytes);
});
