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
/** Standard output of a program that runs in the folder. */
export const run = (program, args) => execFileSync(program, args, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
export const palpate = (...args) => run(PALPATE, args);
