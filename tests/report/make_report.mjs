// SPDX-License-Identifier: GPL-3.0-or-later
// Bakes the block, verifies it, plays a motion and reports.
import { writeFileSync } from "node:fs";
import { at, palpate, played, pressDragLift } from "./folder.mjs";

palpate("build", "scene.toml", "--quiet");
palpate("verify", "scene.toml", "--count", "3", "--report", "verify.json", "--quiet");
const { text } = played(pressDragLift(0.005, 0.002, 0.004), "forces.csv");
writeFileSync(at("motion.csv"), text);
palpate("play", "scene.palp", "motion.csv", "--out", "forces.csv", "--quiet");
palpate("report", "scene.toml", "--verify", "verify.json", "--run", "motion.csv", "--contacts", "2", "--quiet", "--json");
