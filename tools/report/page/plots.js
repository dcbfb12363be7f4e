// SPDX-License-Identifier: GPL-3.0-or-later
// The plots: one idea a plot, units on every axis, every mark from the numbers.
import * as Plot from "@observablehq/plot";
import { make, number, percent } from "./format.js";

const style = { fontSize: "12px", background: "none", color: "currentColor", overflow: "visible" };
const KINDS = { file: "var(--warm)", tolerance: "var(--accent)", scene: "var(--good)", law: "var(--accent)", solve: "var(--soft)" };

/** A plot with its title, what it shows, and a link that saves it as SVG. */
export function framed(title, text, plot, name) {
  const save = make("button", { class: "save", type: "button" }, "save as SVG");
  save.addEventListener("click", () => {
    const svg = (plot.tagName === "svg" ? plot : plot.querySelector("svg")).cloneNode(true);
    const root = getComputedStyle(document.documentElement);
    svg.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    svg.setAttribute("style", "background: white; color: #1d2326; font-family: sans-serif");
    // Variables of the page have no value outside it.
    const text = svg.outerHTML.replace(/var\((--[a-z]+)\)/g, (_, variable) => root.getPropertyValue(variable).trim());
    const link = make("a", { href: URL.createObjectURL(new Blob([text], { type: "image/svg+xml" })), download: name + ".svg" });
    link.click();
  });
  return make("div", { class: "plot", "data-plot": name }, make("h3", {}, title), make("p", {}, text, " ", save), plot);
}

/** Nanoseconds as ns, µs, ms or s. */
function time(ns) {
  const [unit, size] = [["s", 1e9], ["ms", 1e6], ["µs", 1e3]].find(([, size]) => ns >= size) ?? ["ns", 1];
  return `${number(ns / size)} ${unit}`;
}

/** 1, 2 and 5 times powers of ten; powers alone where there are many. */
function ticks(values) {
  const [low, high] = [Math.floor(Math.log10(Math.min(...values))), Math.ceil(Math.log10(Math.max(...values)))];
  const steps = high - low <= 2 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil((high - low) / 5));
  const list = [];
  for (let k = low; k <= high; k += every) for (const step of steps) list.push(step * 10 ** k);
  return list.filter((value) => value <= 10 ** high);
}

// Directions of a label from its dot, the best first.
const SIDES = [
  { textAnchor: "start", dx: 1, dy: 0 }, { textAnchor: "end", dx: -1, dy: 0 }, { textAnchor: "middle", dx: 0, dy: -1 },
  { textAnchor: "middle", dx: 0, dy: 1 }, { textAnchor: "start", dx: 1, dy: -0.8 }, { textAnchor: "start", dx: 1, dy: 0.8 },
  { textAnchor: "end", dx: -1, dy: -0.8 }, { textAnchor: "end", dx: -1, dy: 0.8 },
];
const LABEL_SIZE = 10.5, LABEL_HALF = 0.75 * LABEL_SIZE; // pixels; ascent and descent are up to 1.4 of the size

const STAR = 12; // pixels to the tips of the chosen dot, whose area is that of a disc of radius 7

/** Labels of rows, each at a side of its dot where it covers no dot, no other label and, if possible, no bar: [{row, side}].
 *  A row without such a place has none; the chosen row is first. `bars`: a row's dots as [x, y, radius] (pixels), its
 *  label's first. `frame`: bounds of the labels. */
function labels(rows, bars, frame) {
  const boxAt = ([x, y], w, h) => ({ left: x - w, right: x + w, top: y - h, bottom: y + h });
  const dots = bars.flatMap((each) => each.map(([x, y, r]) => boxAt([x, y], r + 1, r + 1)));
  const lines = bars.map((each) => {
    const [[x]] = each, ys = each.map(([, y]) => y);
    return { left: x - 1, right: x + 1, top: Math.min(...ys), bottom: Math.max(...ys) };
  });
  const inside = (box) => box.left >= frame.left && box.right <= frame.right && box.top >= 0 && box.bottom <= frame.bottom;
  const free = (box, of) => of.every((o) => box.left >= o.right || o.left >= box.right || box.top >= o.bottom || o.top >= box.bottom);
  const marks = [];
  for (const k of [...rows.keys()].sort((a, b) => rows[b].chosen - rows[a].chosen)) {
    const [x, y, r] = bars[k][0], half = 0.31 * LABEL_SIZE * rows[k].short.length;
    const places = SIDES.map((side) => {
      const dx = side.dx * (r + 4), dy = side.dy * (r + LABEL_HALF + 1.5);
      const box = boxAt([x + dx + { start: half, end: -half, middle: 0 }[side.textAnchor], y + dy], half, LABEL_HALF);
      return { row: rows[k], side: { ...side, dx, dy }, box };
    }).filter(({ box }) => inside(box) && free(box, dots));
    const place = places.find(({ box }) => free(box, lines)) ?? places[0];
    if (!place) continue;
    dots.push(place.box);
    marks.push(place);
  }
  return marks;
}

/** Error (median, 95th percentile and worst as one bar) of rows against one of their costs. */
function pareto(rows, { x, label, unit = "", noticeable, width = 380, format = number }) {
  const shown = rows.filter((row) => Number.isFinite(row[x]) && row[x] > 0 && row.error?.count > 0);
  const value = (row, part) => Math.max(100 * row.error[part], 1e-2);
  const title = (row) =>
    `${row.label}\n${number(row[x])} ${unit}\nmedian ${percent(row.error.median)}\n95th percentile ${percent(row.error.p95)}\nworst ${percent(row.error.worst)}`;
  const height = 290, left = 52, below = 42, p95 = (row) => value(row, "p95");
  const plot = (texts) => Plot.plot({
    style, width, height, marginLeft: left, marginBottom: below, marginRight: 24,
    x: { type: "log", label: `${label} →`, labelAnchor: "right", nice: true, ticks: ticks(shown.map((r) => r[x])), tickFormat: (v) => format(v), grid: true, insetLeft: 14, insetRight: 34 },
    y: { type: "log", label: "↑ force error, %", nice: true, ticks: 5, tickFormat: (v) => number(v), grid: true },
    marks: [
      Plot.ruleY([100 * noticeable], { stroke: "currentColor", strokeDasharray: "2 3", strokeOpacity: 0.7 }),
      Plot.link(shown, { x1: x, x2: x, y1: (r) => value(r, "median"), y2: (r) => value(r, "worst"), stroke: (r) => KINDS[r.kind], strokeWidth: 1.2, strokeOpacity: 0.6 }),
      Plot.dot(shown, { x, y: (r) => value(r, "worst"), r: 2.5, symbol: "times", stroke: (r) => KINDS[r.kind], strokeWidth: 1.2 }),
      Plot.dot(shown, { x, y: (r) => value(r, "median"), r: 3, stroke: (r) => KINDS[r.kind], fill: "var(--paper)", strokeWidth: 1.5 }),
      Plot.dot(shown.filter((r) => !r.chosen), { x, y: p95, r: 4.5, fill: (r) => KINDS[r.kind] }),
      Plot.dot(shown.filter((r) => r.chosen), { x, y: p95, r: 7, fill: (r) => KINDS[r.kind], symbol: "star" }),
      Plot.tip(shown, Plot.pointer({ x, y: p95, title, fill: "var(--sheet)" })),
      ...texts.map(({ row, side }) => Plot.text([row], { x, y: p95, text: "short", ...side, fontSize: LABEL_SIZE, fill: "currentColor" })),
    ],
  });
  // Scales place the labels; they follow from a plot without any.
  const bare = plot([]), [u, v] = ["x", "y"].map((name) => bare.scale(name));
  const bars = shown.map((row) => [["p95", row.chosen ? STAR : 4.5], ["median", 3], ["worst", 2.5]].map(([part, r]) => [u.apply(row[x]), v.apply(value(row, part)), r]));
  return plot(labels(shown, bars, { left, right: width, bottom: height - below }));
}

const LAW_NAMES = { "quadratic potential": "quadratic", "linear spring": "linear" };

/** Rows of the laws' plots; the potential is the runtime's law. */
export function lawRows(errorTime) {
  const rows = errorTime.laws.map((law) => ({
    ...law, kind: "law", chosen: law.model === "quadratic potential", label: law.model, short: LAW_NAMES[law.model] ?? law.model,
  }));
  if (errorTime.solve && rows.length) {
    rows.push({ label: "plain solve (its own estimated error)", short: "plain solve", kind: "solve", chosen: false, force_ns: errorTime.solve.ns, error: errorTime.solve.error });
  }
  return rows;
}
export const fileRows = (errorTime) =>
  errorTime.files.map((file) => ({ ...file, short: file.chosen ? "this file" : file.label.replace("tolerance ", "tol. "), bake_seconds: 3600 * file.bake_hours }));

export function errorTimePlots(errorTime) {
  const { noticeable } = errorTime;
  const laws = lawRows(errorTime), files = fileRows(errorTime);
  const plots = [];
  const add = (rows, x, label, unit, title, text, format) => {
    if (rows.filter((r) => Number.isFinite(r[x]) && r.error?.count > 0).length < 1) return;
    plots.push(framed(title, text, pareto(rows, { x, label, unit, noticeable, format }), `error-${x}-${rows[0].kind === "law" ? "laws" : "files"}`));
  };
  const bars = "Ring: median. Dot: 95th percentile. Cross: worst. Dashed: what a hand just notices.";
  add(laws, "force_ns", "time of one force", "ns", "Response laws, by time", `Samples left out of each site's fit. ${bars} The runtime blends sites once a contact; the others are evaluated at three.`, time);
  add(laws, "bytes_per_response", "bytes of a response", "bytes", "Response laws, by memory", `The same errors. ★ is the law of the runtime.`);
  add(files, "tick_ns", "time of a tick", "ns", "Whole files, by time", `Held-out contacts between the sites. ${bars}`, time);
  add(files, "bytes_per_response", "bytes of a response", "bytes", "Whole files, by memory", "The same samples fitted to other tolerances: each chooses degrees and coefficient widths. ★ is this file.");
  if (new Set(files.map((f) => f.bake_hours)).size > 1) {
    add(files, "bake_seconds", "time of the bake, s", "s", "Whole files, by bake", "Other site spacings of the same organ, at the same held-out contacts.");
  }
  return plots;
}

/** Share of held-out contacts within an error. */
export function errorDistribution(places, noticeable) {
  const series = [["normal", "error"], ["tangential", "error_tangential"]].flatMap(([kind, key]) => {
    const errors = places.filter((p) => p.accepted).map((p) => 100 * p[key]).filter((e) => e > 0).sort((a, b) => a - b);
    return errors.map((error, k) => ({ kind, error, share: (100 * (k + 1)) / errors.length }));
  });
  if (!series.length) return null;
  return Plot.plot({
    style, width: 380, height: 290, marginLeft: 52, marginBottom: 42,
    x: { type: "log", label: "largest force error of the contact, % →", nice: true, ticks: 5, tickFormat: (v) => number(v), grid: true },
    y: { label: "↑ contacts with at most this error, %", domain: [0, 100], grid: true },
    color: { domain: ["normal", "tangential"], range: ["var(--accent)", "var(--warm)"], legend: true },
    marks: [
      Plot.ruleX([100 * noticeable], { stroke: "currentColor", strokeDasharray: "2 3", strokeOpacity: 0.7 }),
      Plot.line(series, { x: "error", y: "share", stroke: "kind", curve: "step-after", strokeWidth: 2 }),
      Plot.dot(series, { x: "error", y: "share", fill: "kind", r: 2 }),
    ],
  });
}

/** A site's curves: baked lines, solved dots. */
export function siteCurves(palp, organ, pairs, site, toolVertex) {
  const pair = pairs.find((p) => p.site === site && p.tool_vertex === toolVertex);
  const depth = organ.sites.depth_m[site] || organ.depth_scale_m;
  const depths = Float32Array.from({ length: 40 }, (_, k) => depth * (k / 39) ** 2);
  const baked = [...palp.normalForces(site, toolVertex, depths)].map((force, k) => ({ depth: 1e3 * depths[k], force }));
  const solved = (pair?.normal_m_N ?? []).map(([d, force]) => ({ depth: 1e3 * d, force }));
  const small = { style: { ...style, fontSize: "11px" }, width: 330, height: 170, marginLeft: 44, marginBottom: 34 };
  const charts = [
    Plot.plot({
      ...small,
      x: { label: "depth, mm →", grid: true, nice: true, ticks: 5 },
      y: { label: "↑ normal force, N", grid: true, nice: true, ticks: 4 },
      marks: [
        Plot.line(baked, { x: "depth", y: "force", stroke: "var(--accent)", strokeWidth: 2, className: "baked" }),
        Plot.dot(solved, { x: "depth", y: "force", fill: "var(--warm)", r: 3, className: "solved" }),
      ],
    }),
  ];
  const rays = (pair?.tangential ?? []).filter((ray) => ray.push_m_N.length);
  if (rays.length) {
    const lines = [], dots = [];
    for (const { depth_m: z, direction, push_m_N: pushes } of rays) {
      const name = `${number(1e3 * z, 2)} mm deep`;
      const far = Math.max(...pushes.map(([way]) => way));
      const at = Float32Array.from({ length: 12 }, (_, k) => (far * k) / 11);
      [...palp.tangentialForces(site, toolVertex, z, direction, at)].forEach((force, k) => lines.push({ name, e: 1e3 * at[k], force: -force }));
      pushes.forEach(([way, force]) => dots.push({ name, e: 1e3 * way, force }));
    }
    charts.push(Plot.plot({
      ...small,
      x: { label: "tangential deflection, mm →", grid: true, nice: true, ticks: 5 },
      y: { label: "↑ tangential force, N", grid: true, nice: true, ticks: 4 },
      marks: [
        Plot.line(lines, { x: "e", y: "force", z: "name", stroke: "var(--accent)", strokeWidth: 1.6 }),
        Plot.dot(dots, { x: "e", y: "force", fill: "var(--warm)", r: 3 }),
      ],
    }));
  }
  return { charts, pair, baked, solved };
}
