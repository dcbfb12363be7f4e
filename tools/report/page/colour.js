// SPDX-License-Identifier: GPL-3.0-or-later
// Colour scales that people who see no red or no green can read: viridis (van der Walt and Smith, CC0) and Okabe-Ito.

const VIRIDIS = [0x440154, 0x482878, 0x3e4989, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725];

export const CATEGORIES = {
  solved: "#0072b2",
  measured: "#cc79a7",
  analytic: "#009e73",
  filled: "#e69f00",
  refused: "#d55e00",
  held: "#8a8f91",
  outside: "#c9cac6",
};
export const NEUTRAL = "#9aa09f";

export function parse(hex) {
  const n = parseInt(hex.slice(1), 16);
  return [(n >> 16) / 255, ((n >> 8) & 255) / 255, (n & 255) / 255];
}

/** Red, green, blue in [0, 1] of a share in [0, 1]. */
export function sequential(share) {
  const at = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1);
  const k = Math.min(Math.floor(at), VIRIDIS.length - 2);
  const part = at - k;
  const mix = (shift) => (((VIRIDIS[k] >> shift) & 255) * (1 - part) + ((VIRIDIS[k + 1] >> shift) & 255) * part) / 255;
  return [mix(16), mix(8), mix(0)];
}

export const css = ([r, g, b]) => `rgb(${Math.round(255 * r)} ${Math.round(255 * g)} ${Math.round(255 * b)})`;
export const gradient = () => `linear-gradient(90deg, ${VIRIDIS.map((c) => "#" + c.toString(16).padStart(6, "0")).join(", ")})`;
