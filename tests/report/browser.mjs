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
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });
  const page = await browser.newPage();
  const problems = [], requests = [];
  page.on("console", (message) => ["error", "warn"].includes(message.type()) && problems.push(message.text()));
  page.on("pageerror", (error) => problems.push(error.message));
  page.on("request", (request) => /^(file|blob|data):/.test(request.url()) || requests.push(request.url()));
  await page.setViewport({ width: 1100, height: 800 });
  return { browser, page, problems, requests };
}

export async function openPage(page, url) {
  await page.goto(url);
  await page.waitForFunction("globalThis.palpateReport?.ready", { timeout: 30000 });
}
