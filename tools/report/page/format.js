// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers and elements as the page prints them.

export function number(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-3) return value.toExponential(digits - 1).replace("e+", "e");
  return String(Number(value.toPrecision(digits))).replace(/\B(?=(\d{3})+(?!\d)(?<!\.\d*))/g, "\u202f");
}
export const percent = (share, digits = 3) => (Number.isFinite(share) ? number(100 * share, digits) + " %" : "–");
export const mm = (metres, digits = 3) => number(1e3 * metres, digits) + " mm";

export function bytes(count) {
  if (count >= 1e6) return [number(count / 1e6), "MB"];
  if (count >= 1e3) return [number(count / 1e3), "kB"];
  return [number(count), "bytes"];
}
export function duration(seconds) {
  if (seconds >= 3600) return [number(seconds / 3600), "h"];
  if (seconds >= 60) return [number(seconds / 60), "min"];
  return [number(seconds), "s"];
}

/** An element; strings become text. */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === false || value === undefined || value === null) continue;
    element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

/** `columns`: [title, cell(row), is a number]. */
export function table(rows, columns, rowClass = () => undefined) {
  return make("div", { class: "scroll" },
    make("table", {},
      make("thead", {}, make("tr", {}, columns.map(([title, , right]) => make("th", { class: right ? "number" : undefined }, title)))),
      make("tbody", {}, rows.map((row) => make("tr", { class: rowClass(row) },
        columns.map(([, cell, right]) => make("td", { class: right ? "number" : undefined }, cell(row) ?? "–")))))));
}

export const source = (command) => make("p", { class: "source" }, "Made by ", make("code", {}, command));
