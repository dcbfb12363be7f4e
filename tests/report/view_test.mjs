// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate view` in headless Chromium: a played motion, and a run of a simulated device while it is recorded.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, rmSync } from "node:fs";
import test from "node:test";
import { needChromium, openBrowser, openPage } from "./browser.mjs";
import { at, folder, json, palpate } from "./folder.mjs";

needChromium();

/** A program of this folder; ended by `end`. */
function start(...args) {
  const child = spawn(process.env.PALPATE, args, { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
  const ended = new Promise((resolve) => child.on("exit", (code) => resolve(code)));
  return { child, ended };
}

async function viewing(args, look) {
  const { child, ended } = start("view", ...args, "--port", "0", "--quiet");
  const url = await new Promise((resolve) => child.stdout.once("data", (text) => resolve(String(text).trim())));
  assert.match(url, /^http:\/\/127\.0\.0\.1:\d+\/$/);
  const opened = await openBrowser();
  try {
    await openPage(opened.page, url);
    await look(opened.page);
    assert.deepEqual(opened.problems, []);
    assert.ok(opened.requests.every((request) => request.startsWith(url)), opened.requests.join(" "));
  } finally {
    await opened.browser.close();
    child.kill("SIGINT");
  }
  assert.equal(await ended, 0);
}

test("a motion is played back in the page of a report", () =>
  viewing(["scene.palp", "motion.csv", "--report", "scene.report.json"], async (page) => {
    await page.waitForFunction(() => palpateReport.playback.run?.complete);
    const { run } = json("scene.report.json");
    assert.deepEqual(await page.evaluate("palpateReport.playback.run.force_N"), run.force_N);
    assert.ok((await page.evaluate(() => document.getElementById("stability-body").innerText)).includes("This bake"));
  }));

test("a run is followed while a device makes it", async (t) => {
  const record = "live.palprun";
  rmSync(at(record), { force: true });
  const drive = start("drive", "scene.palp", "--device", "sim", "--seconds", "300", "--record", record, "--plot", "live.svg", "--quiet");
  drive.child.stdout.resume();
  while (!existsSync(at(record))) await new Promise((done) => setTimeout(done, 50));
  await new Promise((done) => setTimeout(done, 500));
  await viewing(["scene.palp", record], async (page) => {
    await page.waitForFunction(() => palpateReport.playback.run?.rows > 0);
    const first = await page.evaluate(() => [palpateReport.playback.run.complete, palpateReport.playback.duration]);
    assert.equal(first[0], false);
    await page.waitForFunction((d) => palpateReport.playback.duration > d, {}, first[1]);
    drive.child.kill("SIGINT");
    await page.waitForFunction(() => palpateReport.playback.run.complete, { timeout: 20000 });
    t.diagnostic(`${first[1]} s, then ${await page.evaluate("palpateReport.playback.duration")} s`);
    assert.equal(await page.evaluate(() => document.getElementById("stability")), null);
  });
  assert.equal(await drive.ended, 0);
});

test("a port that is taken, a file that is none", () => {
  assert.throws(() => palpate("view", "scene.palp", "none.csv", "--port", "0"), /none\.csv/);
  assert.throws(() => palpate("view", "motion.csv", "--port", "0"), /motion\.csv/);
});
