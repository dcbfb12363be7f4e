// SPDX-License-Identifier: GPL-3.0-or-later
// The sections below the organ: tables and plots of the numbers.
import { errorDistribution, errorTimePlots, fileRows, framed, lawRows } from "./plots.js";
import { bytes, duration, make, mm, number, percent, source, table } from "./format.js";

const joined = ([value, unit]) => `${value} ${unit}`;

export function tiles(numbers) {
  const { error_time: cost, stability, held_out: held } = numbers;
  const own = cost.files[0];
  const tile = (title, value, unit, text) =>
    make("div", {}, make("dt", {}, title), make("dd", {}, value, make("small", {}, unit)), make("p", {}, text));
  const error = own.error;
  return [
    error ? tile("Held-out force error", number(100 * error.p95), "%", `95th percentile of ${error.count} forces; median ${percent(error.median)}`)
      : tile("Held-out force error", "–", "", "not measured"),
    tile("One tick", number(own.tick_ns), "ns", "sticking contact, one core"),
    tile("Response file", ...bytes(own.bytes), `${number(own.bytes_per_response)} bytes a response`),
    tile("Bake", ...duration(3600 * own.bake_hours), `${number(stability.bake.solves, 4)} equilibria`),
    tile("Refused", String(stability.bake.refused), `of ${stability.bake.planned}`, "contacts that no gate let pass"),
    tile("Sites", number(own.sites, 4), "", `${mm(own.spacing_m)} apart, ${held.places.length} contacts held out`),
  ];
}

export function errorTime(numbers) {
  const { error_time: cost, held_out: held } = numbers;
  const parts = [];
  if (!held.places.length) {
    parts.push(make("p", { class: "missing" }, "Errors between the sites are not measured. ", make("code", {}, held.command), " measures them."));
  }
  const plots = errorTimePlots(cost);
  const distribution = errorDistribution(held.places, cost.noticeable);
  if (distribution) plots.unshift(framed("Held-out contacts", "Solved anew between the sites, never seen by the fit. Dashed: what a hand just notices.", distribution, "held-out"));
  parts.push(make("div", { class: "plots" }, plots));
  const row = [
    ["", (r) => r.label],
    ["median", (r) => percent(r.error?.median), true],
    ["95th", (r) => percent(r.error?.p95), true],
    ["worst", (r) => percent(r.error?.worst), true],
    ["ns of a force", (r) => number(r.force_ns), true],
    ["ns of a tick", (r) => number(r.tick_ns), true],
    ["bytes a response", (r) => number(r.bytes_per_response), true],
  ];
  const laws = lawRows(cost);
  if (laws.length) parts.push(make("h3", {}, "Response laws at the samples left out"), table(laws, row.filter(([title]) => title !== "ns of a tick"), (r) => (r.chosen ? "chosen" : null)));
  else parts.push(make("p", { class: "missing" }, "Other response laws are not compared: their tangential samples come from a scene with friction, and a report with ", make("code", {}, "--quick"), " leaves them out."));
  parts.push(make("h3", {}, "Files at the held-out contacts"), table(fileRows(cost), [
    ...row.filter(([title]) => title !== "ns of a force"),
    ["bits", (r) => String(r.coefficient_bits), true],
    ["degrees F, g, K, mu", (r) => r.degrees.join(", ")],
    ["spacing", (r) => mm(r.spacing_m), true],
    ["bake", (r) => joined(duration(3600 * r.bake_hours)), true],
  ], (r) => (r.chosen ? "chosen" : null)));
  return parts;
}

const VERDICTS = { "safe in any hand": "good", "settles in a usual grip, not in every hand": "fair", "oscillates in a usual grip": "bad" };

export function stability(numbers) {
  const { bake, battery, battery_command, devices, devices_command } = numbers.stability;
  const facts = [
    ["contacts accepted", `${bake.accepted} of ${bake.planned}`],
    ["tangential pushes that ended early", String(bake.shortened)],
    ["smallest Jacobian (1: undeformed, 0: inside out)", number(bake.smallest_jacobian)],
    ["largest overlap left by the penalty, of the depth", percent(bake.largest_penetration_of_depth)],
    ["iterations: median, 95th percentile, most", [bake.iterations.median, bake.iterations.p95, bake.iterations.worst].map((x) => number(x)).join(", ")],
    ["estimated error of a solve: median, 95th percentile", `${percent(bake.error_estimate.median)}, ${percent(bake.error_estimate.p95)}`],
    ["difference to a finer mesh: median, worst", bake.finer_mesh.compared ? `${percent(bake.finer_mesh.median)}, ${percent(bake.finer_mesh.worst)} (${bake.finer_mesh.compared} contacts)` : "not drawn"],
  ];
  const parts = [make("h3", {}, "This bake"), table(facts, [["", (f) => f[0]], ["", (f) => f[1], true]])];
  if (bake.causes.length) parts.push(make("h3", {}, "Causes of refusals"), table(bake.causes, [["gate", (c) => c.cause], ["contacts", (c) => String(c.pairs), true]]));
  parts.push(source(bake.command));

  if (devices.length) {
    parts.push(make("h3", {}, "On a device"), table(devices, [
      ["device", (d) => d.device],
      ["this file, N/m", (d) => number(d.stiffness_N_per_m), true],
      ["safe in any hand up to, N/m", (d) => number(d.any_hand_N_per_m), true],
      ["a usual grip oscillates from, N/m", (d) => number(d.onset_N_per_m), true],
      ["at, Hz", (d) => number(d.onset_Hz), true],
      ["verdict", (d) => make("span", { class: "verdict-" + VERDICTS[d.verdict] }, d.verdict)],
    ]), source(devices_command));
  }

  parts.push(make("h3", {}, "Stiff and extreme cases"));
  if (!battery) {
    parts.push(make("p", { class: "missing" }, "Not measured for this report. ", make("code", {}, battery_command), " measures them (", make("code", {}, "--battery"), ")."));
    return parts;
  }
  const families = Map.groupBy(battery.cells, (cell) => cell.family);
  parts.push(make("p", { class: "lead" }, "A square is a contact at or beyond the end of a range. Framed: near this scene in modulus, Poisson's ratio and depth over radius."));
  parts.push(make("p", { class: "source" }, ["verified", "converged", "refused", "wrong"].map((result) =>
    make("span", { style: "margin-right: 1rem" }, make("span", { class: "swatch result-" + result, style: "display: inline-block; width: .8rem; height: .8rem; border-radius: 3px; margin-right: .35rem; vertical-align: -.06rem" }), result))));
  for (const [family, cells] of families) {
    parts.push(make("div", { class: "family" }, make("span", {}, family),
      make("div", { class: "cells" }, cells.map((cell) => make("i", {
        class: `result-${cell.result}${cell.near ? " near" : ""}`, title: `${cell.cell}: ${cell.result}${cell.cause ? ", " + cell.cause : ""}`,
      })))));
  }
  const near = battery.cells.filter((cell) => cell.near);
  if (near.length) {
    parts.push(make("details", {}, make("summary", {}, `${near.length} ${near.length === 1 ? "cell" : "cells"} near this scene`), table(near, [
      ["family", (c) => c.family], ["cell", (c) => c.cell], ["result", (c) => c.result], ["cause", (c) => c.cause], ["seconds", (c) => number(c.seconds), true],
    ])));
  }
  parts.push(source(battery_command));
  return parts;
}

export function leftOut(numbers) {
  const { features } = numbers.left_out;
  const columns = [
    ["feature", (f) => make("code", {}, f.name)],
    ["bytes a response", (f) => (f.bytes_per_response ? number(f.bytes_per_response) : "–"), true],
    ["bytes of the file", (f) => (f.bytes === null ? "–" : joined(bytes(f.bytes))), true],
    ["equilibria", (f) => (f.solves ? number(f.solves, 5) : "–"), true],
    ["ns of a press", (f) => (f.tick_ns === undefined ? "–" : number(f.tick_ns)), true],
    ["ns of a slide", (f) => (f.slide_ns === undefined ? "–" : number(f.slide_ns)), true],
  ];
  const used = features.filter((f) => f.present), absent = features.filter((f) => !f.present);
  const causes = (rows) => (rows.some((f) => f.cause) ? [["no time because", (f) => f.cause ?? ""]] : []);
  const parts = [];
  if (numbers.hints.length) parts.push(make("ul", { class: "hints" }, numbers.hints.map((hint) => make("li", {}, hint))));
  parts.push(make("p", { class: "lead" }, "Times are those of a file with the feature less those of the same responses without it: negative where the feature makes a tick faster. A few ns are the measurement's own noise."));
  parts.push(make("h3", {}, "Left out, with what it would take"), table(absent, [...columns, ["so", (f) => f.without], ...causes(absent)]));
  parts.push(make("h3", {}, "Used, with what it takes"), table(used, [...columns, ...causes(used)]));
  return parts;
}

export function provenance(numbers) {
  const p = numbers.provenance;
  return [
    table([
      ["program", `palpate ${p.program}, file version ${p.file_version}`], ["machine", p.machine], ["made", p.made], ["plan", p.manifest],
    ], [["", (f) => f[0]], ["", (f) => f[1]]]),
    make("h3", {}, "Inputs"),
    table(p.inputs, [["file", (i) => i.file], ["bytes", (i) => number(i.bytes, 9), true], ["XXH3, 128 bits", (i) => make("code", {}, i.hash)]]),
    make("h3", {}, "Commands"),
    table([["everything on this page", p.command], ["held-out errors", numbers.held_out.command], ["solved curves", numbers.curves.command], ["contents", numbers.contents.command]],
      [["", (c) => c[0]], ["", (c) => make("code", {}, c[1])]]),
    make("details", {}, make("summary", {}, "What the response file says of itself"), make("pre", {}, JSON.stringify(p.bake, null, 1))),
  ];
}
