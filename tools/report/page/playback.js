// SPDX-License-Identifier: GPL-3.0-or-later
// A recorded run played back: a slider over its time. A run that still grows is followed at its end.
import { number } from "./format.js";

export class Playback {
  constructor(view, poke, elements) {
    Object.assign(this, { view, poke, elements });
    this.at = 0;
    elements.play.addEventListener("click", () => this.toggle());
    elements.time.addEventListener("input", () => {
      this.playing = false;
      this.seek(elements.time.value * this.duration);
    });
  }

  load(run, follow = false) {
    this.run = run;
    this.duration = run.time_s.at(-1) ?? 0;
    this.elements.playback.hidden = !run.time_s.length;
    if (!run.time_s.length) return;
    this.poke.takeTool(run.tool);
    this.seek(follow ? this.duration : this.at);
  }

  toggle() {
    this.playing = !this.playing;
    this.elements.play.textContent = this.playing ? "❚❚" : "▶";
    this.started = performance.now() - 1e3 * (this.at < this.duration ? this.at : 0);
  }

  /** The row at a time (s). */
  seek(time) {
    const { run } = this;
    this.at = Math.min(Math.max(time, 0), this.duration);
    let low = 0, high = run.time_s.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (run.time_s[middle] <= this.at) low = middle;
      else high = middle - 1;
    }
    const force = run.force_N[low], size = Math.hypot(...force);
    const [x, y, z] = run.position_m[low];
    const tool = this.view.organ.tools[run.tool];
    const normal = size > 0 ? force.map((f) => f / size) : [0, 0, 1];
    const skin = [x, y, z].map((p, k) => p - tool.probe_radius_m * normal[k]);
    const depth = run.depth_m[low];
    this.view.show([x, y, z, ...run.quaternion[low]], {
      state: run.state[low], force, depth, normal, toolPoint: skin, bodyPoint: skin.map((p, k) => p + depth * normal[k]),
    }, this.poke.newtonsPerRadius);
    this.elements.time.value = this.duration > 0 ? this.at / this.duration : 0;
    this.elements.timeText.textContent = `${number(this.at)} s, ${number(size)} N`;
  }

  draw() {
    if (!this.playing) return;
    const time = (performance.now() - this.started) / 1e3;
    this.seek(time);
    if (time >= this.duration) this.toggle();
  }
}
