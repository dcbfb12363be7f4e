// SPDX-License-Identifier: GPL-3.0-or-later
// The page in headless Chromium with software rendering.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import test, { after, before } from "node:test";
import { drag, needChromium, openBrowser, openPage } from "./browser.mjs";
import { at, json, played, pressDragLift } from "./folder.mjs";

needChromium();
const report = json("scene.report.json");
let browser, page, problems, requests;
before(async () => {
  ({ browser, page, problems, requests } = await openBrowser());
  await openPage(page, "file://" + at("scene.report.html"));
});
after(() => browser?.close());

test("the page is at most 3 MB and holds the numbers of the JSON file", async () => {
  assert.ok(statSync(at("scene.report.html")).size <= 3e6);
  assert.deepEqual(await page.evaluate("palpateReport.numbers"), report);
});

test("plots hold the data of the numbers", async () => {
  // Each mark's place, mapped back through the plot's own scales.
  const dots = await page.evaluate(() => Object.fromEntries([...document.querySelectorAll("[data-plot]")].map((plot) => {
    const svg = plot.querySelector("svg[class^=plot]") ?? plot.querySelector("svg");
    const scale = plot.querySelector(":scope > svg, :scope > figure")?.scale;
    const circles = [...svg.querySelectorAll("g[aria-label=dot] > *")].map((mark) => {
      if (mark.tagName === "circle") return [Number(mark.getAttribute("cx")), Number(mark.getAttribute("cy"))];
      return mark.getAttribute("transform").match(/-?[\d.]+/g).map(Number);
    });
    const [x, y] = ["x", "y"].map((name) => scale(name));
    return [plot.dataset.plot, circles.map(([cx, cy]) => [x.invert(cx), y.invert(cy)])];
  })));
  const holds = (plot, x, y) => dots[plot].some(([a, b]) => Math.abs(a / x - 1) < 0.02 && Math.abs(b / y - 1) < 0.02);
  for (const file of report.error_time.files) {
    for (const part of ["median", "p95", "worst"]) {
      assert.ok(holds("error-tick_ns-files", file.tick_ns, 100 * file.error[part]), `${file.label} ${part}`);
      assert.ok(holds("error-bytes_per_response-files", file.bytes_per_response, 100 * file.error[part]), `${file.label} ${part}`);
    }
  }
  for (const law of report.error_time.laws) assert.ok(holds("error-force_ns-laws", law.force_ns, 100 * law.error.p95), law.model);
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
});

const client = (point) => page.evaluate((p) => palpateReport.view.project(p), point);

test("hovering a site shows its solved and baked curves", async () => {
  const pair = report.curves.pairs.find((p) => p.normal_m_N);
  await page.evaluate(() => document.getElementById("canvas").scrollIntoView({ block: "center" }));
  await page.mouse.move(...(await client(report.organ.sites.position_m[pair.site])));
  await page.waitForFunction((site) => palpateReport.hovering.shown.site === site, {}, pair.site);
  const shown = await page.evaluate(() => ({
    solved: palpateReport.hovering.shown.solved, baked: palpateReport.hovering.shown.baked.length,
    charts: document.querySelectorAll("#site-curves svg").length, text: document.getElementById("site-curves").innerText,
  }));
  assert.deepEqual(shown.solved, pair.normal_m_N.map(([depth, force]) => ({ depth: 1e3 * depth, force })));
  assert.equal(shown.baked, 40);
  assert.equal(shown.charts, 2);
  assert.match(shown.text, new RegExp(`Site ${pair.site}:`));
});

test("a scripted press, drag across the groove and lift has the native forces within 1e-6", async () => {
  const rows = pressDragLift();
  const native = played(rows, "forces.csv").read();
  const ticks = await page.evaluate((r) => palpateReport.poke.script(0, r), rows);
  const peak = Math.max(...native.map((row) => Math.hypot(...row.force)));
  ticks.forEach((tick, k) => {
    const off = Math.hypot(...tick.force.map((f, i) => f - native[k].force[i]));
    assert.ok(off <= 1e-6 * Math.max(Math.hypot(...native[k].force), 1e-3 * peak), `row ${k}`);
  });
});

test("the mouse presses, drags, tilts and lifts; ticks run at 1 kHz", async (t) => {
  const [x, y] = await client([0, 0, 0]);
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

test("colours, dark mode and a narrow screen", async () => {
  for (const field of await page.evaluate(() => [...document.getElementById("field").options].map((o) => o.value))) {
    await page.select("#field", field);
    assert.ok((await page.evaluate(() => document.getElementById("legend").innerText)).length > 3, field);
  }
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  await page.waitForFunction(() => document.documentElement.dataset.theme === "dark", { timeout: 5000 });
  await page.setViewport({ width: 390, height: 800 });
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390, "the page scrolls sideways");
});

test("notices of all code in the page are in it", async () => {
  const notices = await page.evaluate(() => [...document.querySelectorAll("#licences details")].map((d) => [d.querySelector("summary").textContent, d.querySelector("pre").textContent]));
  for (const name of ["palpate", "three ", "three-mesh-bvh", "@observablehq/plot", "wasi-libc", "libc++"]) {
    const found = notices.find(([summary]) => summary.startsWith(name));
    assert.ok(found && found[1].length > 400, name);
  }
});

test("no error and no request", () => {
  assert.deepEqual(problems, []);
  assert.deepEqual(requests, []);
});
