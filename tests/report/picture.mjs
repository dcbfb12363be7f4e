// SPDX-License-Identifier: GPL-3.0-or-later
// The picture of a page that README shows: a tool drawn over the organ, forces, and curves of the site below it.
import { drag } from "./browser.mjs";

/** Presses left of the middle of the organ of an open page, draws the tool aside until it slides, and writes a PNG of what the
 *  page shows then to `file`; lifts the tool. The page is as large as the picture afterwards. */
export async function takePicture(page, file) {
  await page.setViewport({ width: 1180, height: 700 });
  const [x, y] = await page.evaluate(() => {
    document.getElementById("organ").scrollIntoView();
    const box = document.getElementById("canvas").getBoundingClientRect();
    return [box.left + box.width / 2, box.top + box.height / 2];
  });
  // The resolution stays that of the display: an interval that is no number never reduces it.
  await page.evaluate(() => Object.assign(palpateReport.view.moving, { ratio: 1, interval: NaN }));
  await page.mouse.move(x - 100, y - 60);
  await page.mouse.down();
  await page.waitForFunction(() => document.querySelector("#readout span")?.innerText === "stick", { timeout: 5000 });
  await drag(page, (s) => [x - 100 + 40 * s, y - 60 - 5 * s], 2);
  await page.waitForFunction(() => document.querySelector("#readout span")?.innerText === "slide" && document.querySelector("#site-curves svg"), { timeout: 5000 });
  await page.screenshot({ path: file });
  await page.mouse.up();
}
