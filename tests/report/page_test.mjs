// SPDX-License-Identifier: GPL-3.0-or-later
// The page in headless Chromium with software rendering.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { drag, needChromium, openBrowser, openPage } from "./browser.mjs";
import { at, json, palpate } from "./folder.mjs";
import { playedForces, pressDragLift } from "./motion.mjs";
import { checkForces, checkHovering, checkNumbers, checkPlots, clientOf, showOrgan } from "./page_checks.mjs";

needChromium();
const report = json("scene.report.json");
let browser, page, problems, requests;
before(async () => {
  ({ browser, page, problems, requests } = await openBrowser());
  await openPage(page, "file://" + at("scene.report.html"));
});
after(() => browser?.close());

test("the page is at most 3 MB and holds the numbers of the JSON file", () => checkNumbers(page, report, at("scene.report.html")));

test("plots hold the data of the numbers", async () => {
  const names = await checkPlots(page, report);
  for (const name of ["held-out", "error-tick_ns-files", "error-force_ns-laws"]) assert.ok(names.includes(name), name);
});

test("a label of a plot covers no dot and no other label", async () => {
  const plots = await page.evaluate(() => [...document.querySelectorAll("[data-plot^=error-] > svg")].map((plot) => {
    const boxes = (selector) => [...plot.querySelectorAll(selector)].map((e) => [e.textContent, e.getBoundingClientRect().toJSON()]);
    return { labels: boxes("g[aria-label=text] text"), dots: boxes("g[aria-label=dot] > *") };
  }));
  const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top + 2 < b.bottom && b.top + 2 < a.bottom;
  for (const { labels, dots } of plots) {
    assert.ok(labels.some(([text]) => ["quadratic", "this file"].includes(text)), "the chosen dot has no label");
    labels.forEach(([text, box], k) => {
      for (const [other, taken] of [...labels.slice(k + 1), ...dots]) assert.ok(!overlap(box, taken), `${text} covers ${other || "a dot"}`);
    });
  }
});

test("tables print the numbers and the commands that made them", async () => {
  const text = await page.evaluate(() => document.body.innerText);
  const own = report.error_time.files[0];
  for (const printed of [
    `${Number((100 * own.error.p95).toPrecision(3))} %`, String(own.bytes_per_response), report.provenance.manifest,
    ...report.provenance.inputs.map((input) => input.hash), ...report.stability.devices.map((d) => d.device),
    ...[report.organ, report.error_time, report.stability.bake, report.left_out, report.provenance].map((part) => part.command),
    report.stability.battery_command, report.stability.devices_command,
  ]) assert.ok(text.includes(printed), printed);
});

test("each cell of the battery is a square with its cause", async () => {
  const cells = await page.evaluate(() => [...document.querySelectorAll("#stability .cells i")].map((i) => [i.className, i.title]));
  assert.deepEqual(cells.map(([name]) => name), ["result-verified near", "result-wrong", "result-converged", "result-refused"]);
  assert.match(cells[3][1], /a gate/);
  assert.equal(await page.evaluate(() => document.querySelector("#stability details summary").textContent), "1 cell near this scene");
});

test("hovering a site shows its solved and baked curves", async () => {
  const pair = await checkHovering(page, report);
  assert.ok(pair.tangential.length > 0);
});

test("a scripted press, drag across the groove and lift has the native forces within 1e-6", async () => {
  await checkForces(page, pressDragLift(), playedForces("forces.csv"));
});

test("the mouse presses, drags, tilts and lifts; ticks run at 1 kHz", async (t) => {
  const [x, y] = await clientOf(page, [0, 0, 0]);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.waitForFunction(() => document.querySelector("#readout b")?.innerText.match(/[1-9]/), { timeout: 5000 });
  const { ticks, frames } = await drag(page, (t) => [x + 48 * t, y], 1);
  t.diagnostic(`${ticks.toFixed(0)} ticks and ${frames.toFixed(1)} frames a second`);
  assert.ok(Math.abs(ticks / 1000 - 1) < 0.1, `${ticks} ticks a second`);
  assert.ok(frames > 5, `${frames} frames a second`);  // beside other tests; organ_pages_test.mjs has the rate
  const state = await page.evaluate(() => document.querySelector("#readout span").innerText);
  assert.equal(state, "slide");
  const depth = await page.evaluate(() => palpateReport.view.material.uniforms.dentDepth.value);
  assert.ok(Math.abs(depth - report.organ.depth_scale_m / 2) < 0.1 * report.organ.depth_scale_m, `dent of ${depth} m`);
  await page.mouse.wheel({ deltaY: 100 });
  assert.ok((await page.evaluate(() => palpateReport.poke.tilt)) > 0);
  await page.mouse.up();
  assert.equal(await page.evaluate(() => document.getElementById("readout").innerText), "");
});

test("a slider plays the run", async () => {
  await page.evaluate(() => {
    const slider = document.getElementById("time");
    slider.value = 0.5;
    slider.dispatchEvent(new Event("input"));
  });
  const k = await page.evaluate(() => palpateReport.playback.run.time_s.findLastIndex((t) => t <= palpateReport.playback.at));
  const shown = await page.evaluate(() => palpateReport.view.tool.position.toArray());
  report.run.position_m[k].forEach((p, i) => assert.ok(Math.abs(shown[i] - p) < 1e-6));
});

test("colours, dark mode, print and a narrow screen", async () => {
  for (const field of await page.evaluate(() => [...document.getElementById("field").options].map((o) => o.value))) {
    await page.select("#field", field);
    assert.ok((await page.evaluate(() => document.getElementById("legend").innerText)).length > 3, field);
  }
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  await page.waitForFunction(() => document.documentElement.dataset.theme === "dark", { timeout: 5000 });
  const ink = () => page.evaluate(() => getComputedStyle(document.body).color);
  const dark = await ink();
  await page.emulateMediaType("print");
  assert.notEqual(await ink(), dark, "a dark page is printed in light ink");
  await page.emulateMediaType("screen");
  await page.setViewport({ width: 390, height: 800 });
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390, "the page scrolls sideways");
});

test("notices of all code in the page are in it", async () => {
  const notices = await page.evaluate(() => [...document.querySelectorAll("#licences details")].map((d) => [d.querySelector("summary").textContent, d.querySelector("pre").textContent]));
  const permission = /Permission is hereby granted|Permission to use, copy, modify/;
  for (const [name, text] of [
    ["palpate runtime", permission], ["palpate page", /GNU GENERAL PUBLIC LICENSE/], ["three ", permission], ["three-mesh-bvh", permission],
    ["@observablehq/plot", permission], ["wasi-libc", /wasi-libc contributors/], ["libc++-", /LLVM Exceptions/], ["libclang-rt-", /LLVM Exceptions/],
  ]) {
    const found = notices.find(([summary]) => summary.startsWith(name));
    assert.match(found?.[1] ?? "", text, name);
  }
});

test("a finger presses, drags and lifts", async () => {
  await page.setViewport({ width: 390, height: 800, hasTouch: true, isMobile: true });
  await openPage(page, "file://" + at("scene.report.html"));
  await showOrgan(page);
  const [x, y] = await clientOf(page, [0, 0, 0]);
  await page.touchscreen.touchStart(x, y);
  await page.waitForFunction(() => document.querySelector("#readout span")?.innerText === "stick");
  const scrolled = await page.evaluate(() => scrollY);
  for (let k = 1; k <= 20; k++) await page.touchscreen.touchMove(x + k, y);
  await page.waitForFunction(() => document.querySelector("#readout span")?.innerText === "slide");
  assert.equal(await page.evaluate(() => scrollY), scrolled, "the drag scrolls the page");
  await page.touchscreen.touchEnd();
  assert.equal(await page.evaluate(() => document.getElementById("readout").innerText), "");
});

test("two organs are drawn side by side, with one scale", async () => {
  palpate("report", "scene.toml", "--compare", "scene.palp", "--quick", "--contacts", "2", "--numbers", "two.json", "--page", "two.html", "--quiet");
  await page.setViewport({ width: 1100, height: 800 });
  await openPage(page, "file://" + at("two.html"));
  await page.waitForFunction(() => palpateReport.views.length === 2 && palpateReport.views.every((view) => view.frames > 0));
  const [tints, boxes, names] = await page.evaluate(() => [
    palpateReport.views.map((view) => [...view.geometry.getAttribute("tint").array]),
    ["canvas", "canvas-compared"].map((id) => document.getElementById(id).getBoundingClientRect().toJSON()),
    document.getElementById("names").innerText,
  ]);
  assert.deepEqual(tints[1], tints[0]);  // the same file twice
  assert.ok(new Set(tints[0]).size > 3);
  assert.ok(boxes[0].right <= boxes[1].left && boxes[1].width > 200);
  assert.match(names, /scene\.palp/);
});

test("no error and no request", () => {
  assert.deepEqual(problems, []);
  assert.deepEqual(requests, []);
});
