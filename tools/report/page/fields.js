// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers and categories of the sites that colour the organ.
import { CATEGORIES } from "./colour.js";

const finite = (list) => list?.some((x) => Number.isFinite(x));

/** Source of each site's response, with refusals and supports. */
function kinds(organ, tool, refused) {
  return organ.sites.held.map((held, site) =>
    held ? "held" : organ.sites.outside[site] ? "outside" : refused.has(site) ? "refused" : tool.source[site]);
}

/** [{id, label, unit, values (per site, in the unit), categories}] of one tool; values may be null. */
export function fieldsOf(organ, toolIndex, pairs = []) {
  const tool = organ.tools[toolIndex];
  const refused = new Set(pairs.filter((p) => p.refused && p.tool_vertex === tool.first_vertex).map((p) => p.site));
  const depth = `${(1e3 * organ.field_depth_m).toPrecision(3)} mm`;
  const scaled = (list, by) => list?.map((x) => (x === null ? null : by * x));
  const fields = [
    { id: "stiffness", label: `Stiffness at ${depth}`, unit: "N/m", values: tool.stiffness_N_per_m },
    { id: "force", label: `Force at ${depth}`, unit: "N", values: tool.force_N },
    { id: "friction", label: "Friction coefficient", unit: "", values: tool.friction_coefficient },
    { id: "error-fit", label: "Error of the fit, 95th percentile", unit: "%", values: scaled(tool.error_fit, 100) },
    { id: "error-solve", label: "Estimated error of the solve", unit: "%", values: scaled(tool.error_solve, 100) },
    { id: "error-between", label: "Estimated error between sites", unit: "%", values: scaled(tool.error_neighbours, 100) },
    { id: "kind", label: "Solved, filled or refused", categories: CATEGORIES, values: kinds(organ, tool, refused) },
    { id: "thickness", label: "Thickness", unit: "mm", values: scaled(organ.sites.thickness_m, 1e3) },
    { id: "depth", label: "Deepest push", unit: "mm", values: scaled(organ.sites.depth_m, 1e3) },
  ];
  return fields.filter((f) => f.values && (f.categories || finite(f.values)));
}

/** [low, high] over the sites of all fields, their outer 2 % left out. */
export function rangeOf(...fields) {
  const values = fields.flatMap((f) => f.values.filter((x) => Number.isFinite(x))).sort((a, b) => a - b);
  const at = (share) => values[Math.round(share * (values.length - 1))];
  const [low, high] = [at(0.02), at(0.98)];
  return high > low ? [low, high] : [low, low + Math.max(Math.abs(low), 1e-9) * 1e-3];
}
