// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the page together from the numbers and the response files that lie in it.
import { css, gradient } from "./colour.js";
import { fieldsOf, rangeOf } from "./fields.js";
import { make, mm, number } from "./format.js";
import { OrganView } from "./organ.js";
import { fromPlanes, Palp } from "./palp.js";
import { Playback } from "./playback.js";
import { siteCurves } from "./plots.js";
import { Poke } from "./poke.js";
import * as sections from "./sections.js";

const element = (id) => document.getElementById(id);
const unpack = globalThis.unpack;

function theme(views) {
  const root = document.documentElement;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const apply = (mode) => {
    root.dataset.theme = mode;
    for (const view of views) view.dark(mode === "dark");
  };
  element("theme").addEventListener("click", () => apply(root.dataset.theme === "dark" ? "light" : "dark"));
  dark.addEventListener("change", () => apply(dark.matches ? "dark" : "light"));
  apply(dark.matches ? "dark" : "light");
}

function legend(field, range) {
  if (field.categories) {
    const used = new Set(field.values);
    element("legend").replaceChildren(make("strong", {}, field.label), ...[...used].map((name) =>
      make("div", {}, make("span", { class: "swatch", style: `background: ${field.categories[name]}` }), name)));
    return;
  }
  element("legend").replaceChildren(
    make("strong", {}, field.label), field.unit ? `, ${field.unit}` : "",
    make("div", { class: "bar", style: `background: ${gradient()}` }),
    make("div", { class: "ends" }, make("span", {}, number(range[0])), make("span", {}, number((range[0] + range[1]) / 2)), make("span", {}, number(range[1]))));
}

/** Field and tool chosen by the controls, on both organs with one scale. */
function fieldControls(views, numbers, poke) {
  const { organ, compared, curves } = numbers;
  let fields = [];
  const show = () => {
    const field = fields[element("field").selectedIndex];
    const other = compared ? fieldsOf(compared, Math.min(element("tool").selectedIndex, compared.tools.length - 1)).find((f) => f.id === field.id) : null;
    const range = field.categories ? null : rangeOf(field, ...(other ? [other] : []));
    views[0].colour(field, range);
    if (views[1] && other) views[1].colour(other, range);
    legend(field, range);
  };
  const list = () => {
    const chosen = fields[element("field").selectedIndex]?.id;
    fields = fieldsOf(organ, element("tool").selectedIndex, curves.pairs);
    element("field").replaceChildren(...fields.map((f) => make("option", { value: f.id, selected: f.id === chosen }, f.label)));
    show();
  };
  element("tool").replaceChildren(...organ.tools.map((tool) => make("option", {}, tool.name)));
  element("tool").addEventListener("change", () => {
    poke?.takeTool(element("tool").selectedIndex);
    list();
  });
  element("field").addEventListener("change", show);
  list();
}

function hover(view, palp, numbers) {
  const { organ, curves } = numbers;
  const shown = { site: -1 };
  const show = (site) => {
    const tool = organ.tools[element("tool").selectedIndex];
    if (shown.site === site && shown.tool === tool) return;
    Object.assign(shown, { site, tool });
    const { charts, pair, baked, solved } = siteCurves(palp, organ, curves.pairs, site, tool.first_vertex);
    Object.assign(shown, { baked, solved });
    const about = [mm(organ.sites.depth_m[site]) + " deep", tool.source[site], number(tool.stiffness_N_per_m[site]) + " N/m"];
    element("site-curves").replaceChildren(
      make("p", { style: "margin: 0 0 .3rem" }, make("strong", {}, `Site ${site}`), `: ${about.join(", ")}`),
      make("p", { class: "source", style: "margin: 0" }, make("span", { class: "key solved" }, "solved"), make("span", { class: "key baked" }, "baked"), pair?.refused ? " refused: " + pair.refused : ""),
      ...charts);
  };
  let waiting = null;
  view.canvas.addEventListener("pointermove", (event) => {
    waiting ??= requestAnimationFrame(() => {
      waiting = null;
      const hit = view.pick(event.clientX, event.clientY);
      if (hit) show(hit.site);
    });
  });
  return { shown, show };
}

function toggles(view) {
  for (const [id, part] of [["show-regions", "regions"], ["show-sites", "sites"], ["show-held-out", "heldOut"]]) {
    const box = element(id);
    box.checked = view[part].visible && box.checked;
    if (part === "regions") view.regions.visible = box.checked = view.regions.children.length > 0;
    box.closest("label").hidden = part === "regions" && !view.regions.children.length;
    box.addEventListener("change", () => {
      view[part].visible = box.checked;
      view.invalidate();
    });
  }
}

async function main() {
  const numbers = JSON.parse(new TextDecoder().decode(await unpack("palpate-numbers")));
  const page = (globalThis.palpateReport = { numbers });
  numbers.curves ??= { pairs: [] };
  numbers.held_out ??= { places: [] };
  if (numbers.error_time) element("tiles").replaceChildren(...sections.tiles(numbers));
  else element("tiles").hidden = true;
  const parts = { "error-time": ["error_time", sections.errorTime], stability: ["stability", sections.stability], "left-out": ["left_out", sections.leftOut], provenance: ["provenance", sections.provenance] };
  for (const [id, [name, build]] of Object.entries(parts)) {
    if (numbers[name]) {
      element(id + "-body").replaceChildren(...build(numbers));
      continue;
    }
    // The page of a response file alone has no bake.
    element(id).remove();
    document.querySelector(`.contents a[href="#${id}"]`).remove();
  }
  for (const place of document.querySelectorAll("[data-source]")) {
    place.append("Made by ", make("code", {}, numbers[place.dataset.source].command));
  }

  const wasm = await unpack("palpate-poke");
  const file = fromPlanes(await unpack("palpate-response-0"));
  const palp = await Palp.open(wasm, file);
  page.palp = palp;
  const views = [];
  try {
    views.push(new OrganView(element("canvas"), palp, numbers.organ, numbers.held_out.places));
  } catch (error) {
    element("blocked").hidden = false;
    element("blocked").textContent = "This browser has no WebGL: the organ cannot be drawn. Every number is below.";
    console.warn(error.message);
    theme(views);
    return;
  }
  const [view] = views;
  if (numbers.compared) {
    element("canvas-compared").hidden = false;
    const other = await Palp.open(wasm, fromPlanes(await unpack("palpate-response-1")));
    views.push(new OrganView(element("canvas-compared"), other, numbers.compared));
    views[1].takeTool(0);
    element("names").hidden = false;
    element("names").replaceChildren(make("span", {}, numbers.title), make("span", {}, numbers.compared.file));
  }
  const depth = element("depth");
  const depthText = () => (element("depth-text").textContent = mm(depth.value * numbers.organ.depth_scale_m, 2));
  depth.addEventListener("input", depthText);
  depthText();
  const poke = new Poke(view, numbers.organ, wasm, file, { readout: element("readout"), trace: element("trace"), depth });
  poke.takeTool(0);
  const playback = new Playback(view, poke, { playback: element("playback"), play: element("play"), time: element("time"), timeText: element("time-text") });
  fieldControls(views, numbers, poke);
  toggles(view);
  theme(views);
  const hovering = hover(view, palp, numbers);
  if (numbers.run) playback.load(numbers.run);
  if (numbers.live) follow(playback, numbers.live);
  Object.assign(page, { view, views, poke, playback, hovering, css });

  const frame = (now) => {
    poke.draw();
    playback.draw();
    for (const each of views) each.draw(now);
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
  await poke.ready;
  page.ready = true;
}

/** Asks the server of `palpate view` for the run again while it grows. */
async function follow(playback, url) {
  for (;;) {
    const answer = await fetch(url);
    if (answer.ok) {
      const run = await answer.json();
      playback.load(run, !run.complete);
      if (run.complete) return;
    }
    await new Promise((resolve) => setTimeout(resolve, 500));
  }
}

main().catch((error) => {
  element("blocked").hidden = false;
  element("blocked").textContent = error.message;
  console.error(error);
});
