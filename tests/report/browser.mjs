// SPDX-License-Identifier: GPL-3.0-or-later
// Headless Chromium with software rendering, and what went wrong in it.
import { createRequire } from "node:module";
import path from "node:path";
import { chromium, pageBuild } from "./folder.mjs";

export function needChromium() {
  if (chromium) return;
  console.log("skipped: no chromium");
  process.exit(0);
}

/** {browser, page, problems: texts of errors and warnings, requests: URLs but of files and of what a page makes itself}. */
export async function openBrowser() {
  const puppeteer = createRequire(path.join(pageBuild, "package.json"))("puppeteer-core");
  const browser = await puppeteer.launch({
    executablePath: chromium,
    // As on a machine without a graphics card: SwiftShader draws WebGL, the browser's own raster the rest of the page.
    args: ["--no-sandbox", "--disable-gpu-compositing", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  const page = await browser.newPage();
  const problems = [], requests = [];
  // The driver's note that the browser itself reads the canvas back is none of the page's.
  const own = (message) => !/GL Driver Message \(OpenGL, Performance, .*ReadPixels/.test(message.text());
  page.on("console", (message) => ["error", "warn"].includes(message.type()) && own(message) && problems.push(message.text()));
  page.on("pageerror", (error) => problems.push(error.message));
  page.on("request", (request) => /^(file|blob|data):/.test(request.url()) || requests.push(request.url()));
  await page.setViewport({ width: 1100, height: 800 });
  return { browser, page, problems, requests };
}

export async function openPage(page, url) {
  await page.goto(url);
  await page.waitForFunction("globalThis.palpateReport?.ready", { timeout: 30000 });
}

/** Moves the pressed mouse along `path` (s to client pixels) for `seconds`: {ticks, frames} a second, and {resolution}: drawn
 *  pixels for each of the display's, along a side. */
export async function drag(page, path, seconds) {
  const count = () => page.evaluate(() => {
    const { poke, view } = palpateReport;
    return { ticks: poke.ticks, frames: view.frames, resolution: view.moving.ratio, at: performance.now() / 1e3 };
  });
  const before = await count(), begun = performance.now(), moves = [];
  for (;;) {
    const t = (performance.now() - begun) / 1e3;
    moves.push(page.mouse.move(...path(Math.min(t, seconds))));  // an awaited move waits for a frame
    if (t >= seconds) break;
    await new Promise((done) => setTimeout(done, 8));
  }
  await Promise.all(moves);
  const after = await count(), time = after.at - before.at;
  return { ticks: (after.ticks - before.ticks) / time, frames: (after.frames - before.frames) / time, resolution: after.resolution };
}
