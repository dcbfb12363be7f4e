// SPDX-License-Identifier: GPL-3.0-or-later
// Bakes the block, verifies it, plays a motion and reports.
import { rmSync, writeFileSync } from "node:fs";
import { at, palpate } from "./folder.mjs";
import { motionText, pressDragLift } from "./motion.mjs";

rmSync(at("scene.work"), { recursive: true, force: true });  // of an earlier program
palpate("build", "scene.toml", "--quiet");
palpate("verify", "scene.toml", "--count", "3", "--report", "verify.json", "--quiet");
writeFileSync(at("motion.csv"), motionText(pressDragLift()));
palpate("play", "scene.palp", "motion.csv", "--out", "forces.csv", "--quiet");
// Cells of the stiff battery, as its report lists them.
writeFileSync(at("battery.json"), JSON.stringify({ battery: "stiff", seed: 1, tolerance: 0.05, machine: "", all: {}, cells: [
  { family: "modulus", cell: "E 1000 Pa, nu 0.49, depth 1 R", core: true, converged: true, seconds: 3, difference: 0.002 },
  { family: "modulus", cell: "E 1e+09 Pa, nu 0.49, depth 1 R", core: false, converged: true, seconds: 3, difference: 0.2 },
  { family: "modulus", cell: "E 1000 Pa, nu 0.3, depth 1 R", core: true, converged: true, seconds: 3 },
  { family: "modulus", cell: "E 1000 Pa, nu 0.49, depth 0.2 R", core: true, converged: false, cause: "a gate", seconds: 3 },
] }));
palpate("report", "scene.toml", "--verify", "verify.json", "--battery", "battery.json", "--run", "motion.csv", "--contacts", "2", "--quiet", "--json");
