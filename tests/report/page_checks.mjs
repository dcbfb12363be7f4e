// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of a page that is open in the browser: it holds the numbers of its JSON file, draws plots and curves of these
// numbers, and gives the forces of the native runtime. `report`: the JSON.
import assert from "node:assert/strict";
import { statSync } from "node:fs";

/** Page size in MB; the page holds the numbers of the JSON. `file`: its HTML. */
export async function checkNumbers(page, report, file) {
  const megabytes = statSync(file).size / 1e6;
  assert.ok(megabytes <= 3, `${megabytes} MB`);
  assert.deepEqual(await page.evaluate("palpateReport.numbers"), report);
  return megabytes;
}

/** Dots of each plot below `selector`, in the units of its axes: {plot's name or place: [[x, y], ...]}. */
const drawnDots = (page, selector) => page.evaluate((all) =>
  // Each mark's place, mapped back through the plot's own scales.
  Object.fromEntries([...document.querySelectorAll(all)].map((drawn, k) => {
    const [x, y] = ["x", "y"].map((name) => drawn.scale(name));
    const marks = [...drawn.querySelectorAll("g[aria-label=dot] > *")].map((mark) =>
      mark.tagName === "circle" ? [mark.getAttribute("cx"), mark.getAttribute("cy")]
        : mark.getAttribute("transform").match(/-?[\d.]+/g));
    return [drawn.parentElement.dataset.plot ?? k, marks.map(([cx, cy]) => [x.invert(Number(cx)), y.invert(Number(cy))])];
  })), selector);

/** Dots are those expected, in any order, to 1e-3. */
function sameDots(dots, expected, name) {
  assert.equal(dots?.length, expected.length, `dots of ${name}`);
  const near = (a, b) => Math.abs(a - b) <= 1e-3 * Math.abs(b) + 1e-12;
  const left = [...dots];
  for (const [x, y] of expected) {
    const k = left.findIndex(([a, b]) => near(a, x) && near(b, y));
    assert.ok(k >= 0, `${name} has no dot at ${x}, ${y}`);
    left.splice(k, 1);
  }
}

/** Dots of every plot that the numbers make, by the plot's name. */
function expectedDots({ error_time: { files, laws, solve }, held_out: { places } }) {
  const plots = {};
  const pareto = (name, rows, cost, factor = 1) => {
    const dots = rows.filter((row) => row.error && row[cost] > 0)
      .flatMap((row) => ["median", "p95", "worst"].map((part) => [factor * row[cost], Math.max(100 * row.error[part], 0.01)]));
    if (dots.length) plots[name] = dots;
  };
  const lawRows = laws.length && solve ? [...laws, { error: solve.error, force_ns: solve.ns }] : laws;
  pareto("error-force_ns-laws", lawRows, "force_ns");
  pareto("error-bytes_per_response-laws", lawRows, "bytes_per_response");
  pareto("error-tick_ns-files", files, "tick_ns");
  pareto("error-bytes_per_response-files", files, "bytes_per_response");
  if (new Set(files.map((file) => file.bake_hours)).size > 1) pareto("error-bake_seconds-files", files, "bake_hours", 3600);
  const shares = ["error", "error_tangential"].flatMap((kind) => {
    const errors = places.filter((place) => place.accepted && place[kind] > 0).map((place) => 100 * place[kind]).sort((a, b) => a - b);
    return errors.map((error, k) => [error, (100 * (k + 1)) / errors.length]);
  });
  if (shares.length) plots["held-out"] = shares;
  return plots;
}

/** Names of the plots; each has a dot for each number, and no other. The page says which
 *  errors are not measured. */
export async function checkPlots(page, report) {
  const dots = await drawnDots(page, "[data-plot] > :is(svg, figure)"), expected = expectedDots(report);
  assert.deepEqual(Object.keys(dots).sort(), Object.keys(expected).sort());
  for (const name in expected) sameDots(dots[name], expected[name], name);
  const missing = await page.evaluate(() => [...document.querySelectorAll("#error-time .missing")].map((p) => p.innerText).join("\n"));
  assert.equal(missing.includes(report.held_out.command), report.held_out.places.length === 0);
  assert.equal(missing.includes("response laws"), report.error_time.laws.length === 0);
  return Object.keys(dots);
}

export const showOrgan = (page) => page.evaluate(() => document.getElementById("canvas").scrollIntoView({ block: "center" }));
export const clientOf = (page, point) => page.evaluate((p) => palpateReport.view.project(p), point);

/** Solved pairs of the first tool whose sites the picture shows: those that a pointer above them finds. */
async function pairsInView(page, report) {
  const pairs = report.curves.pairs.filter((pair) => pair.normal_m_N && pair.tool_vertex === report.organ.tools[0].first_vertex);
  const found = await page.evaluate((points) => points.map((point) => palpateReport.view.pick(...palpateReport.view.project(point))?.site),
    pairs.map((pair) => report.organ.sites.position_m[pair.site]));
  return pairs.filter((pair, k) => found[k] === pair.site);
}

/** The pair whose solved and baked curves a pointer above its site shows. */
export async function checkHovering(page, report) {
  await showOrgan(page);
  const [pair] = await pairsInView(page, report);
  assert.ok(pair, "the picture shows no solved site");
  await page.mouse.move(...(await clientOf(page, report.organ.sites.position_m[pair.site])));
  await page.waitForFunction((site) => palpateReport.hovering.shown.site === site, {}, pair.site);
  const shown = await page.evaluate(() => ({
    baked: palpateReport.hovering.shown.baked, text: document.getElementById("site-curves").innerText,
  }));
  assert.match(shown.text, new RegExp(`Site ${pair.site}:`));
  const dots = Object.values(await drawnDots(page, "#site-curves > :is(svg, figure)"));
  const rays = pair.tangential.filter((ray) => ray.push_m_N.length);
  assert.equal(dots.length, rays.length ? 2 : 1);
  sameDots(dots[0], pair.normal_m_N.map(([depth, force]) => [1e3 * depth, force]), "the normal curve");
  if (rays.length) sameDots(dots[1], rays.flatMap((ray) => ray.push_m_N.map(([way, force]) => [1e3 * way, force])), "the tangential curves");
  // The baked curve is that of the file: it passes the force at half depth, which the runtime's header gave to the JSON.
  const { field_depth_m: depth, tools: [tool] } = report.organ;
  const after = shown.baked.findIndex((point) => point.depth >= 1e3 * depth), [a, b] = shown.baked.slice(after - 1, after + 1);
  const force = a.force + ((1e3 * depth - a.depth) / (b.depth - a.depth)) * (b.force - a.force);
  assert.ok(Math.abs(force / tool.force_N[pair.site] - 1) < 0.01, `${force} N instead of ${tool.force_N[pair.site]} N`);
  return pair;
}

/** The page's tool has the forces that `palpate play` gave along poses [x, y, z, w, x, y, z]. */
export async function checkForces(page, rows, native) {
  assert.equal(native.length, rows.length);
  const ticks = await page.evaluate((r) => palpateReport.poke.script(0, r), rows);
  const peak = Math.max(...native.map((row) => Math.hypot(...row.force)));
  assert.ok(peak > 0.01, `${peak} N`);
  ticks.forEach((tick, k) => {
    const off = Math.hypot(...tick.force.map((f, i) => f - native[k].force[i]));
    // Below a millionth of the peak the printed digits of the native force end.
    assert.ok(off <= 1e-6 * Math.max(Math.hypot(...native[k].force), 1e-3 * peak), `row ${k}`);
  });
}
