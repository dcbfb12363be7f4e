// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime as WebAssembly, with one response file open in it (tools/report/poke/poke.cpp).

export const STATES = ["free", "stick", "slide", "released", "fault"];

/** Bytes of a response file whose words of four were sorted into planes. */
export function fromPlanes(planes) {
  const bytes = new Uint8Array(planes.length);
  let from = 0;
  for (let plane = 0; plane < 4; plane++) {
    for (let k = plane; k < bytes.length; k += 4) bytes[k] = planes[from++];
  }
  return bytes;
}

export class Palp {
  /** `wasm`: bytes of the module; `file`: bytes of a response file. Throws where the runtime refuses the file. */
  static async open(wasm, file) {
    const { instance } = await WebAssembly.instantiate(wasm, {});
    return new Palp(instance, file);
  }

  constructor(instance, file) {
    this.exports = instance.exports;
    this.exports._initialize();
    const at = this.exports.reserve_file(file.length);
    new Uint8Array(this.exports.memory.buffer).set(file, at);
    const error = this.#text(this.exports.open_file(file.length));
    if (error) throw new Error(error);
    this.vertexCount = this.exports.vertex_count();
    this.triangleCount = this.exports.triangle_count();
  }

  #text(at) {
    const bytes = new Uint8Array(this.exports.memory.buffer, at);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
  #floats(at, count) {
    return new Float32Array(this.exports.memory.buffer, at, count).slice();
  }
  #indices(at, count) {
    return new Uint32Array(this.exports.memory.buffer, at, count).slice();
  }

  positions() { return this.#floats(this.exports.positions(), 3 * this.vertexCount); }
  normals() { return this.#floats(this.exports.normals(), 3 * this.vertexCount); }
  triangles() { return this.#indices(this.exports.triangles(), 3 * this.triangleCount); }
  vertexSites() { return this.#indices(this.exports.vertex_sites(), 3 * this.vertexCount); }
  vertexWeights() { return this.#floats(this.exports.vertex_weights(), 3 * this.vertexCount); }

  /** Baked normal forces (N) at depths (m). */
  normalForces(site, toolVertex, depths) {
    const at = this.exports.reserve_numbers(depths.length);
    new Float32Array(this.exports.memory.buffer, at, depths.length).set(depths);
    this.exports.normal_forces(site, toolVertex);
    return this.#floats(at, depths.length);
  }
  /** Baked forces (N) along a unit direction at deflections (m) along it, at one depth (m). */
  tangentialForces(site, toolVertex, depth, direction, deflections) {
    const at = this.exports.reserve_numbers(deflections.length);
    new Float32Array(this.exports.memory.buffer, at, deflections.length).set(deflections);
    this.exports.tangential_forces(site, toolVertex, depth, direction[0], direction[1]);
    return this.#floats(at, deflections.length);
  }

  takeTool(tool) { this.exports.take_tool(tool); }

  /** One tick at a pose [x, y, z (m), quaternion w, x, y, z]. */
  tick(pose) {
    new Float64Array(this.exports.memory.buffer, this.exports.tool_pose(), 7).set(pose);
    const at = this.exports.tick();
    const f = new Float64Array(this.exports.memory.buffer, at, 20);
    return {
      state: f[0],
      force: [f[1], f[2], f[3]],
      torque: [f[4], f[5], f[6]],
      depth: f[7],
      frictionLimit: f[8],
      filledShare: f[9],
      extrapolated: f[10] > 0,
      normal: [f[11], f[12], f[13]],
      bodyPoint: [f[14], f[15], f[16]],
      toolPoint: [f[17], f[18], f[19]],
    };
  }
}
