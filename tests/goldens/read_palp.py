#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads response files and evaluates them, written from formats/response/response-file.md alone: Python's standard library, no
line of Palpate's own code.

read_palp.py FOLDER      every FOLDER/*.palp: reads all fields, checks what the specification says that a reader checks,
                         and compares with the answers in the .forces file beside it (tests/goldens/goldens.hpp);
                         ends with 1 where one differs
read_palp.py FILE.palp   prints every field as text
"""
import json
import math
import pathlib
import struct
import sys

M64 = (1 << 64) - 1
BIAS, FRICTION, TOOL_PATCHES, SEARCH, BONDED, TORQUE, SPIN, SOFTENING, COMPLIANCE = (1 << bit for bit in range(9))


class Bad(Exception):
    pass


def need(good, what):
    if not good:
        raise Bad(what)


def xxh64(data):
    p1, p2, p3, p4, p5 = (0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x85EBCA77C2B2AE63,
                          0x27D4EB2F165667C5)
    rotate = lambda v, n: (v << n | v >> (64 - n)) & M64
    step = lambda lane, word: rotate((lane + word * p2) & M64, 31) * p1 & M64
    whole = len(data) // 32 * 32
    h = p5
    if whole:
        lanes = [(p1 + p2) & M64, p2, 0, -p1 & M64]
        for words in struct.iter_unpack("<4Q", data[:whole]):
            lanes = [step(lane, word) for lane, word in zip(lanes, words)]
        h = sum(rotate(lane, n) for lane, n in zip(lanes, (1, 7, 12, 18))) & M64
        for lane in lanes:
            h = ((h ^ step(0, lane)) * p1 + p4) & M64
    h = (h + len(data)) & M64
    rest = data[whole:]
    while len(rest) >= 8:
        h = (rotate(h ^ step(0, int.from_bytes(rest[:8], "little")), 27) * p1 + p4) & M64
        rest = rest[8:]
    if len(rest) >= 4:
        h = (rotate(h ^ (int.from_bytes(rest[:4], "little") * p1 & M64), 23) * p2 + p3) & M64
        rest = rest[4:]
    for byte in rest:
        h = rotate(h ^ (byte * p5 & M64), 11) * p1 & M64
    h = (h ^ h >> 33) * p2 & M64
    h = (h ^ h >> 29) * p3 & M64
    return h ^ h >> 32


# Vectors as tuples.
def add(*vs):
    return tuple(map(sum, zip(*vs)))


def mul(s, v):
    return tuple(s * x for x in v)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def sub(a, b):
    return add(a, mul(-1, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(v):
    return mul(1 / math.sqrt(dot(v, v)), v)


def text(raw):
    need(0 in raw, "a name without its zero")
    return raw[:raw.index(0)].decode()


def is_unit(v):
    return abs(dot(v, v) - 1) < 1e-3


class File:
    """Every field, by the names of the specification."""

    def __init__(self, data):
        self.data = data
        need(len(data) >= 64, "shorter than a header")
        magic, version, count, size, checksum, self.features = struct.unpack_from("<8s2I2QI", data)
        need(magic == b"PALPATE\0", "magic bytes")
        need(version == 4, "version")
        need(size == len(data) and size % 64 == 0, "size")
        need(xxh64(data[:24] + bytes(8) + data[32:]) == checksum, "checksum")
        need(count <= 32 and not any(data[36:64]) and self.features < 512, "header")
        self.sections = {}
        covered = bytearray(len(data))
        covered[:64 + 32 * count] = b"\1" * (64 + 32 * count)
        last, end = 0, 64 + 32 * count
        for i in range(count):
            number, element, offset, size, elements = struct.unpack_from("<2I3Q", data, 64 + 32 * i)
            need(number > last and number < 17, "section ids")
            need(offset % 64 == 0 and offset >= end and offset + size <= len(data), "section place")
            need(1 <= elements < 1 << 31 and size == elements * element, "section size")
            self.sections[number] = (element, elements, data[offset:offset + size])
            covered[offset:offset + size] = b"\1" * size
            last, end = number, offset + size
        need(all(c or not b for c, b in zip(covered, data)), "bytes between sections are not zero")
        self.read_meta()
        self.read_body()
        self.read_tools()
        self.read_spins()
        self.read_responses()
        self.read_bonded()
        self.read_torques()
        self.read_search()
        self.read_compliance()
        provenance = self.section(13, 1)
        self.provenance = json.loads(provenance)
        need(isinstance(self.provenance, dict), "PROVENANCE")
        need(not self.sections, "sections that do not belong here: %s" % list(self.sections))

    def section(self, number, element, count=None):
        need(number in self.sections, "section %d is missing" % number)
        have, elements, data = self.sections.pop(number)
        need(have == element and count in (None, elements), "section %d: elements" % number)
        return data

    def records(self, number, layout, count):
        return list(struct.iter_unpack(layout, self.section(number, struct.calcsize(layout), count)))

    def read_meta(self):
        meta = struct.unpack("<2d18I4f24s", self.section(1, 128, 1))
        self.Z, self.X = meta[:2]
        (self.site_count, self.vertex_count, self.triangle_count, self.tool_count, self.tool_vertex_count,
         self.tool_patch_count, self.response_count, self.k, self.bonded_coefs, self.search_nodes) = meta[2:12]
        self.degrees = normal, bias, stiffness, friction = meta[12:16]
        self.bits, self.softenings, self.patch_count, self.index_bytes = meta[16:20]
        self.origin, self.unit = meta[20:23], meta[23]
        need(not any(meta[24]), "META: zero bytes")
        most = max(self.site_count, self.vertex_count, self.triangle_count, self.patch_count)
        need(self.index_bytes == (2 if most <= 65536 else 4), "META: bytes of an index")
        need(self.vertex_count >= self.site_count, "META: vertices")
        need(1e-9 <= self.Z < 1000 and (self.X == 0 or 1e-9 <= self.X < 1000), "META: scales")
        self.friction_families = self.X > 0
        need(2 <= normal <= 6 and (bias == 0 or 2 <= bias <= 6), "META: degrees")
        if self.friction_families:
            need((stiffness == 0 or 2 <= stiffness <= 6) and friction <= 6, "META: degrees")
        else:
            need(stiffness == friction == 0, "META: degrees in a frictionless file")
        need(self.bits in (8, 12, 16), "META: bits")
        need(self.bonded_coefs == 0 or 4 <= self.bonded_coefs <= 32, "META: coefficients of a bonded curve")
        need(self.softenings <= self.friction_families, "META: softenings")
        need(1 <= self.k <= 255, "META: subdivision")
        need(self.response_count == self.site_count * self.tool_vertex_count, "META: responses")
        need(self.features == (BIAS * (bias > 0) | FRICTION * self.friction_families
                               | TOOL_PATCHES * bool(self.tool_patch_count) | SEARCH * bool(self.search_nodes)
                               | BONDED * (self.bonded_coefs > 0) | TORQUE * (11 in self.sections)
                               | SPIN * (8 in self.sections) | SOFTENING * self.softenings
                               | COMPLIANCE * (14 in self.sections)), "features")

    def is_limit(self, depth):
        return 0 < depth <= self.Z * (1 + 1e-5)

    def read_body(self):
        self.sites = []
        for r in self.records(2, "<7fI", self.site_count):
            site = {"normal": r[:3], "tangent": r[3:6], "depth_limit": r[6], "flags": r[7]}
            need(is_unit(r[:3]) and is_unit(r[3:6]) and abs(dot(r[:3], r[3:6])) < 1e-3 and self.is_limit(r[6])
                 and r[7] < 4, "SITES")
            self.sites.append(site)
        self.vertices = self.records(3, "<3f", self.vertex_count)
        need(all(abs(x) < 1e5 for v in self.vertices for x in v), "SURFACE_VERTICES")
        index = "H" if self.index_bytes == 2 else "I"
        patches = self.records(16, "<3" + index, self.patch_count)
        need(all(len(set(p)) == 3 and max(p) < self.site_count for p in patches), "SURFACE_PATCHES")
        self.triangles = []
        for r in self.records(4, "<7%s6B" % index, self.triangle_count):
            grid = [(r[7 + 2 * i], r[8 + 2 * i], self.k - r[7 + 2 * i] - r[8 + 2 * i]) for i in range(3)]
            need(len(set(r[:3])) == 3 and max(r[:3]) < self.vertex_count and max(r[3:6]) < self.triangle_count
                 and r[6] < self.patch_count and min(map(min, grid)) >= 0, "SURFACE_TRIANGLES")
            self.triangles.append({"vertex": r[:3], "neighbour": r[3:6], "site": patches[r[6]], "grid": grid})
            for vertex, weights in zip(r[:3], grid):
                at = [site for site, weight in zip(patches[r[6]], weights) if weight == self.k]
                need(at == [vertex] if at else vertex >= self.site_count, "SURFACE_TRIANGLES: corner at a site")
        for number, t in enumerate(self.triangles):
            for i in range(3):
                a, b = (i + 1) % 3, (i + 2) % 3
                other = self.triangles[t["neighbour"][i]]
                theirs = [j for j in range(3) if other["neighbour"][j] == number
                          and other["vertex"][(j + 1) % 3] == t["vertex"][b]
                          and other["vertex"][(j + 2) % 3] == t["vertex"][a]]
                need(theirs, "SURFACE_TRIANGLES: neighbours")
                j = theirs[0]
                need(self.weights_at(t, a) == self.weights_at(other, (j + 2) % 3)
                     and self.weights_at(t, b) == self.weights_at(other, (j + 1) % 3), "SURFACE_TRIANGLES: weights")

    def weights_at(self, triangle, corner):
        return {site: weight for site, weight in zip(triangle["site"], triangle["grid"][corner]) if weight}

    def read_tools(self):
        self.tools = []
        patched = bool(self.features & TOOL_PATCHES)
        vertex = patch = 0
        for r in self.records(5, "<32s5I3f", self.tool_count):
            tool = dict(zip(("name", "kind", "first_vertex", "vertex_count", "first_patch", "patch_count", "radius",
                             "probe_radius", "axis_length"), (text(r[0]),) + r[1:]))
            need(tool["name"] and tool["kind"] < 3 and tool["vertex_count"] > 0 and all(0 <= x < 1e5 for x in r[6:]),
                 "TOOLS")
            need((tool["first_vertex"], tool["first_patch"]) == (vertex, patch) and patched == (tool["patch_count"] > 0)
                 and (patched or tool["vertex_count"] == 1), "TOOLS: vertices and patches")
            need(tool["kind"] == 2 or tool["axis_length"] > 0 or tool["vertex_count"] == 1, "TOOLS: no axis")
            need(tool["kind"] == 1 or tool["axis_length"] == 0, "TOOLS: axis")
            need(tool["kind"] != 2 or tool["probe_radius"] == 0, "TOOLS: probe radius")
            vertex += tool["vertex_count"]
            patch += tool["patch_count"]
            self.tools.append(tool)
        need((vertex, patch) == (self.tool_vertex_count, self.tool_patch_count), "TOOLS: all")
        self.tool_vertices, self.tool_patches = [], []
        if not patched:
            return
        for r in self.records(6, "<10f24s", self.tool_vertex_count):
            self.tool_vertices.append({"point": r[:3], "normal": r[3:6], "tangent": r[6:9], "meridian": r[9],
                                       "name": text(r[10])})
            need(all(abs(x) < 1e5 for x in r[:3] + r[9:10]) and is_unit(r[3:6]) and is_unit(r[6:9])
                 and abs(dot(r[3:6], r[6:9])) < 1e-3, "TOOL_VERTICES")
        self.tool_patches = self.records(7, "<3I", self.tool_patch_count)
        for tool in self.tools:
            own = range(tool["first_vertex"], tool["first_vertex"] + tool["vertex_count"])
            last = -math.inf
            for p in self.tool_patches[tool["first_patch"]:tool["first_patch"] + tool["patch_count"]]:
                need(all(v in own for v in p), "TOOL_PATCHES")
                if tool["kind"] == 1:
                    low, high = (self.tool_vertices[v]["meridian"] for v in p[:2])
                    need(last <= low <= high, "TOOL_PATCHES: segments")
                    last = high

    def read_spins(self):
        self.spins = [1] * self.tool_vertex_count
        if not self.features & SPIN:
            return
        need(self.tool_patches, "SPINS without TOOL_VERTICES")
        self.spins = [r[0] for r in self.records(8, "<I", self.tool_vertex_count)]
        need(max(self.spins) > 1, "SPINS: none")
        for tool in self.tools:
            first, end = tool["first_vertex"], tool["first_vertex"] + tool["vertex_count"]
            while first < end:
                count, head = self.spins[first], self.tool_vertices[first]
                need(1 <= count <= 64 and first + count <= end, "SPINS: count")
                need(count == 1 or tool["kind"] != 1 or head["tangent"][2] >= 0, "SPINS: a profile's tangent")
                for k in range(1, count):
                    v = self.tool_vertices[first + k]
                    need(self.spins[first + k] == 0 and all(v[key] == head[key] for key in ("point", "normal", "meridian")),
                         "SPINS: later spins")
                    a, t, n = 2 * math.pi * k / count, head["tangent"], head["normal"]
                    off = sub(add(mul(math.cos(a), t), mul(math.sin(a), cross(n, t))), v["tangent"])
                    need(dot(off, off) < 1e-6, "SPINS: tangent")
                first += count
        need(all(self.spins[v] for p in self.tool_patches for v in p), "TOOL_PATCHES: a later spin")

    def read_responses(self):
        head = 8 + 4 * self.softenings
        counts = {name: len(indices) * len(parts) for name, (indices, parts) in self.families().items()}
        limits = counts.get("mu", 0)
        before = sum(counts.values()) - limits
        packed = (before * self.bits + 15) // 16 * 2
        size = head + (4 + packed + 2 * limits + 3) // 4 * 4
        data = self.section(9, size, self.response_count)
        self.responses = []
        for i in range(self.response_count):
            element = data[i * size:(i + 1) * size]
            depth, flags = struct.unpack_from("<fI", element)
            need(self.is_limit(depth) and flags in (1, 2, 4, 8), "RESPONSES: head")
            to = {"depth_limit": depth, "flags": flags}
            self.responses.append(to)
            if self.softenings:
                (to["softening"],) = struct.unpack_from("<f", element, 8)
                need(0 <= to["softening"] <= 0.2 * (1 + 1e-6), "RESPONSES: slip softening")
            law = element[head:]
            to["unit"] = struct.unpack_from("<f", law)[0]
            stream = int.from_bytes(law[4:4 + packed], "little")
            coefs = [stream >> self.bits * k & (1 << self.bits) - 1 for k in range(before)]
            need(0 <= to["unit"] <= 1e12 / 32768 and stream >> self.bits * before == 0
                 and not any(law[4 + packed + 2 * limits:]), "RESPONSES: unit or padding")
            to["coefs"] = [c - (c >> self.bits - 1 << self.bits) for c in coefs] + list(
                struct.unpack_from("<%dh" % limits, law, 4 + packed))
            self.check_passive(self.families_of(to))

    def of_tool(self, key):
        """(responses of a tool, whether the first has `key` above 0), tool by tool."""
        for tool in self.tools:
            own = range(tool["first_vertex"], tool["first_vertex"] + tool["vertex_count"])
            responses = [self.responses[site * self.tool_vertex_count + v] for site in range(self.site_count) for v in own]
            yield responses, responses[0][key] != 0

    def read_bonded(self):
        if not self.features & BONDED:
            return
        n = self.bonded_coefs
        curves = lambda r: [r[i * n:i * n + n] for i in range(6)]
        for to, r in zip(self.responses, self.records(10, "<2f%df" % (6 * n), self.response_count)):
            to["bonded_depth"], to["pulled"], to["bonded"] = r[0], r[1], curves(r[2:])
        for responses, bonds in self.of_tool("bonded_depth"):
            for r in responses:
                if not bonds:
                    need(not any((r["bonded_depth"], r["pulled"])) and not any(map(any, r["bonded"])), "BONDED: zero")
                    continue
                need(self.is_limit(r["bonded_depth"]) and (r["pulled"] == 0 or self.is_limit(r["pulled"])),
                     "BONDED: depths")
                need(all(abs(c) <= 1e12 for curve in r["bonded"] for c in curve), "BONDED: size")
                need(all(a <= b for a, b in zip(r["bonded"][2], r["bonded"][2][1:])), "BONDED: normal force")
                need(all(is_level(curve) for curve in r["bonded"][3:]), "BONDED: level")
                need(all(xx >= 0 and yy >= 0 and xy * xy <= xx * yy for xx, xy, yy in zip(*r["bonded"][3:])),
                     "BONDED: stiffness")

    def read_torques(self):
        if not self.features & TORQUE:
            return
        need(self.features & BONDED, "BONDED_TORQUE without BONDED")
        n = self.bonded_coefs
        for to, r in zip(self.responses, self.records(11, "<f%df" % (15 * n), self.response_count)):
            to["rotated"], to["torque"] = r[0], [r[1 + i * n:1 + i * n + n] for i in range(15)]
        for responses, rotates in self.of_tool("rotated"):
            for r in responses:
                if not rotates:
                    need(r["rotated"] == 0 and not any(map(any, r["torque"])), "BONDED_TORQUE: zero")
                    continue
                need(0 < r["rotated"] <= 1 + 1e-5 and r["bonded_depth"] > 0, "BONDED_TORQUE: angle or bond")
                need(all(abs(c) <= 1e12 for curve in r["torque"] for c in curve), "BONDED_TORQUE: size")
                need(all(is_level(curve) for curve in r["torque"][3:]), "BONDED_TORQUE: level")
                for i in range(n):
                    K, C = torque_tensors([curve[i] for curve in r["torque"]])
                    xx, xy, yy = (curve[i] for curve in r["bonded"][3:])
                    rows = [[xx, xy] + C[0], [xy, yy] + C[1]] + [[C[0][j], C[1][j]] + K[j] for j in range(3)]
                    for j in range(5):
                        rows[j][j] *= 1 - 1e-6
                    need(is_positive(rows), "BONDED_TORQUE: stiffness")

    def families(self):
        """Name: the indices of the coefficients that are stored, the harmonic of each component (0: one number)."""
        normal, bias, stiffness, friction = self.degrees
        families = {"F": (range(2, normal + 1), (0,))}
        if bias:
            families["g"] = (range(2, bias + 1), (1,))
        if self.friction_families:
            families["K'"] = (range(stiffness + 1), (0, 2))
            families["A"] = (range(2, stiffness + 1), (0, 2))
            families["mu"] = (range(friction + 1), (0,))
        return {name: (indices, [h for h in parts for _ in range(2 if h else 1)])
                for name, (indices, parts) in families.items()}

    def families_of(self, response):
        """Name: {harmonic: Bernstein coefficients, 0 where not stored}, N but for mu; harmonics as complex numbers."""
        coefs = list(response["coefs"])
        result = {}
        for name, (indices, parts) in self.families().items():
            scale = 1 / 3200 if name == "mu" else response["unit"]
            family = {h: [0] * (indices[-1] + 1 if indices else 1) for h in parts}
            for i in indices:
                for h in sorted(family):
                    value = complex(coefs.pop(0), coefs.pop(0)) if h else coefs.pop(0)
                    family[h][i] = scale * value
            result[name] = family
        return result

    def check_passive(self, law):
        need(all(a <= b for a, b in zip([0] + law["F"][0], law["F"][0])), "RESPONSES: F")
        if not self.friction_families:
            return
        need(all(0 <= c <= 10 for c in law["mu"][0]), "RESPONSES: mu")
        largest = max(abs(part) for name in ("K'", "A") for family in law[name].values() for c in family
                      for part in (complex(c).real, complex(c).imag))
        for i in range(self.degrees[2] + 1):
            for sign in (1, -1):
                mean, second = (law["K'"][h][i] + sign * law["A"][h][i] for h in (0, 2))
                need(mean - abs(second) >= -1e-12 * largest, "RESPONSES: passivity")

    def read_search(self):
        self.search = []
        if not self.search_nodes:
            need(not any(self.origin) and self.unit == 0, "META: a search grid without SEARCH")
            return
        need(all(abs(x) < 1e5 for x in self.origin) and 0 < self.unit < 1e5, "META: search grid")
        at = lambda box: tuple(o + self.unit * c for o, c in zip(self.origin, box))
        for r in self.records(12, "<6HI", self.search_nodes):
            self.search.append({"lower": at(r[:3]), "upper": at(r[3:6]), "first": r[6] % 2 ** 27, "count": r[6] >> 27})
        holds = lambda node, p: all(l <= x <= u for l, x, u in zip(node["lower"], p, node["upper"]))
        visited, next_triangle, open_nodes = set(), 0, [(0, 1)]
        while open_nodes:
            number, depth = open_nodes.pop()
            need(number not in visited and depth <= 48, "SEARCH: not a tree")
            visited.add(number)
            node = self.search[number]
            if node["count"]:
                need(node["first"] == next_triangle, "SEARCH: order")
                next_triangle += node["count"]
                need(next_triangle <= self.triangle_count, "SEARCH: triangles")
                for t in self.triangles[node["first"]:next_triangle]:
                    need(all(holds(node, self.vertices[v]) for v in t["vertex"]), "SEARCH: box of a leaf")
                continue
            need(number < node["first"] < self.search_nodes - 1, "SEARCH: children")
            for child in (node["first"] + 1, node["first"]):
                need(holds(node, self.search[child]["lower"]) and holds(node, self.search[child]["upper"]), "SEARCH: box")
                open_nodes.append((child, depth + 1))
        need(len(visited) == self.search_nodes and next_triangle == self.triangle_count, "SEARCH: left out")

    # Evaluation.

    def read_compliance(self):
        self.compliance = []
        if not self.features & COMPLIANCE:
            return
        self.modes, self.negative, self.poisson, self.rounding = struct.unpack_from("<2I2d", self.section_head())
        need(self.modes <= 128 and self.modes % 8 == 0 and self.negative <= self.modes, "COMPLIANCE: modes")
        need(0 <= self.poisson < 0.5 and 1e-9 <= self.rounding < 1000, "COMPLIANCE: numbers")
        for r in self.records(15, "<2f%dh" % (3 * self.modes), len(self.sites)):
            need(1e-6 <= r[0] < 1e15 and 0 <= r[1] < 1e6, "COMPLIANCE_SITES")
            self.compliance.append((r[0], [mul(r[1], r[2 + 3 * m:5 + 3 * m]) for m in range(self.modes)]))

    def section_head(self):
        head = self.section(14, 64, 1)
        need(not any(head[24:]), "COMPLIANCE: reserved bytes")
        return head

    def shared(self, start, end):
        """Rows of C(end, start)."""
        places = []
        for triangle, b in (start, end):
            numbers, a, n, _ = self.contact(triangle, b)
            c = add(*(mul(x, self.vertices[v]) for x, v in zip(b, self.triangles[triangle]["vertex"])))
            shear = sum(x * self.compliance[site][0] for x, site in zip(a, numbers))
            modes = [add(*(mul(x, self.compliance[site][1][m]) for x, site in zip(a, numbers)))
                     for m in range(self.modes)]
            places.append((c, n, shear, modes))
        (c0, n0, g0, v0), (c1, n1, g1, v1) = places
        d, N = sub(c1, c0), add(n0, n1)
        rho = math.sqrt(dot(d, d) + self.rounding ** 2)
        u = unit(N) if dot(N, N) > 0 else (0, 0, 0)
        t = mul(1 / rho, sub(d, mul(dot(d, u), u)))
        factor, nu = dot(N, N) / 4 / (4 * math.pi * math.sqrt(g0 * g1) * rho), self.poisson
        rows = []
        for i in range(3):
            for j in range(3):
                x = factor * (2 * (1 - nu) * (i == j) + 2 * nu * t[i] * t[j] + (1 - 2 * nu) * (t[i] * u[j] - u[i] * t[j]))
                for m in range(self.modes):
                    x += (1 if m < self.modes - self.negative else -1) * v1[m][i] * v0[m][j]
                rows.append(x)
        return rows

    def contact(self, triangle, b):
        """Weights of the patch's sites, n(c), and each site's frame carried to c."""
        t = self.triangles[triangle]
        numbers = t["site"]
        a = [sum(b[c] * t["grid"][c][i] for c in range(3)) / self.k for i in range(3)]
        n = add(*(mul(a[i], self.sites[numbers[i]]["normal"]) for i in range(3)))
        if math.sqrt(dot(n, n)) <= 1e-6:
            p = [self.vertices[v] for v in t["vertex"]]
            n = cross(sub(p[1], p[0]), sub(p[2], p[0]))
        n = unit(n)
        frames = []
        for number in numbers:
            ux, normal = self.sites[number]["tangent"], self.sites[number]["normal"]
            if dot(normal, n) > -0.999:
                ux = sub(ux, mul(dot(ux, n) / (1 + dot(normal, n)), add(normal, n)))
            ux = unit(sub(ux, mul(dot(ux, n), n)))
            frames.append((ux, cross(n, ux)))
        return numbers, a, n, frames

    def pairs(self, contact, tool, patch, w, rotation=None):
        """(weight, frame, response) of every response that takes part. rotation: of the tool; None: at its first spins."""
        numbers, a, n, frames = contact
        corners = self.tool_patches[patch] if self.tool_patches else (self.tools[tool]["first_vertex"],)
        if self.tools[tool]["vertex_count"] == 1:
            corners, w = (self.tools[tool]["first_vertex"],), (1,)
        return [(a[i] * weight * share, frame, self.responses[numbers[i] * self.tool_vertex_count + vertex + spin])
                for i in range(3) for vertex, weight in zip(corners, w) if a[i] > 0 and weight > 0
                for share, frame, spin in self.spun(self.tools[tool], vertex, n, frames[i], rotation)]

    def spun(self, tool, vertex, n, frame, rotation):
        """(share, frame, number) of the spins of a tool vertex that answer at a site."""
        count = self.spins[vertex]
        if count == 1 or rotation is None:
            return [(1, frame, 0)]
        turn = lambda v: tuple(dot(rotation[3 * i:3 * i + 3], v) for i in range(3))
        lost = False
        if tool["kind"] == 1:
            h = turn((0, 0, 1))
            cosine = dot(h, n)
            lost = self.tool_vertices[vertex]["tangent"][2] > 0.9
        else:
            m, h = turn(self.tool_vertices[vertex]["normal"]), turn(self.tool_vertices[vertex]["tangent"])
            cosine = -dot(m, n)
            if 1 + cosine > 1e-9:
                h = add(h, mul(dot(h, n) / (1 + cosine), sub(m, n)))
        h = sub(h, mul(dot(h, n), n))
        h = unit(h) if dot(h, h) > 1e-24 else frame[0]
        sure = min(1, 2 * math.sqrt(max(0, 1 - cosine * cosine))) if lost or cosine < 0 else 1
        at = math.atan2(dot(h, frame[1]), dot(h, frame[0])) / (2 * math.pi) % 1 * count
        below = math.floor(at)
        result = [(1 - sure, frame, 0)]
        for spin, share in ((below, below + 1 - at), (below + 1, at - below)):
            back = 2 * math.pi * (spin % count) / count
            x = sub(mul(math.cos(back), h), mul(math.sin(back), cross(n, h)))
            result.append((sure * share, (x, cross(n, x)), spin % count))
        return [r for r in result if r[0] > 0]

    def force(self, triangle, b, tool, patch, w, delta, rotation=None):
        contact = self.contact(triangle, b)
        n = contact[2]
        z = -dot(delta, n)
        pairs = self.pairs(contact, tool, patch, w, rotation)
        if z <= 0:
            return (0.0, 0.0, 0.0, 0.0)
        law, ux, uy = self.law(pairs, n)
        fn, side, limit = law.force(z, complex(dot(delta, ux), dot(delta, uy)))
        return add(mul(fn, n), mul(side.real, ux), mul(side.imag, uy)) + (limit,)

    def bonded_wrench(self, triangle, b, tool, patch, w, delta, theta=(0, 0, 0)):
        """Force and torque on a bonded tool, response by response in its site's frame: the law is linear in the curves,
        and the rotation of a frame rotates force and torque."""
        contact = self.contact(triangle, b)
        n = contact[2]
        z, force, torque = -dot(delta, n), (0, 0, 0), (0, 0, 0)
        angle = math.sqrt(dot(theta, theta))
        for weight, (ux, uy), r in self.pairs(contact, tool, patch, w):
            local = lambda v: (dot(v, ux), dot(v, uy), dot(v, n))
            x, y, _ = local(delta)
            (Fx, Fy, Fn, xx, xy, yy), (dFx, dFy, _, dxx, dxy, dyy) = self.over_depth(r["bonded"], z)
            f = [Fx - xx * x - xy * y, Fy - xy * x - yy * y,
                 Fn - dFx * x - dFy * y + (dxx * x * x + 2 * dxy * x * y + dyy * y * y) / 2]
            if "torque" in r:
                values, slopes = self.over_depth(r["torque"], z)
                (K, C), (dK, dC) = torque_tensors(values), torque_tensors(slopes)
                o, v = stretch(angle)
                t = local(theta)
                energy = lambda t: self.rotation_energy(values[:3], K, C, x, y, t)
                turned, even = ([s * c for c in t] for s in (o, v))
                f[0] -= dot(C[0], turned)
                f[1] -= dot(C[1], turned)
                f[2] += (-dot(slopes[:3], turned) + x * dot(dC[0], turned) + y * dot(dC[1], turned)
                         + sum(even[i] * dot(dK[i], even) for i in range(3)) / 2)
                # dW/dtheta by its definition; the torque from J^T torque = -dW/dtheta.
                d = 1e-5
                step = lambda i, s: tuple(c + s * (i == j) for j, c in enumerate(t))
                slope = [(8 * (energy(step(i, d)) - energy(step(i, -d))) - energy(step(i, 2 * d))
                          + energy(step(i, -2 * d))) / (12 * d) for i in range(3)]
                own = solve(transposed(left_jacobian(t)), [-s for s in slope])
                torque = add(torque, mul(weight * own[0], ux), mul(weight * own[1], uy), mul(weight * own[2], n))
            force = add(force, mul(weight * f[0], ux), mul(weight * f[1], uy), mul(weight * f[2], n))
        return force + torque

    def over_depth(self, curves, z):
        """Values at a depth and slopes by it: T and F linear beyond the range, the others level."""
        L = 1.25 * self.Z
        u = (z / L + 1) / 2
        inside = max(0, min(1, u))
        values, slopes = [], []
        for number, c in enumerate(curves):
            m = len(c) - 3
            rise = spline_slope(c, inside)
            values.append(spline(c, inside) + ((u - inside) * rise if number < 3 else 0))
            slopes.append(rise / (2 * L))
        return values, slopes

    @staticmethod
    def rotation_energy(T, K, C, x, y, t):
        o, v = stretch(math.sqrt(dot(t, t)))
        turned, even = ([s * c for c in t] for s in (o, v))
        return (-dot(T, turned) + x * dot(C[0], turned) + y * dot(C[1], turned)
                + sum(even[i] * dot(K[i], even) for i in range(3)) / 2)

    def law(self, pairs, n):
        """The blend in one tangent basis at c, and that basis."""
        ux = unit(cross(n, (1, 0, 0) if abs(n[0]) < 0.6 else (0, 1, 0)))
        uy = cross(n, ux)
        blend = {}
        for weight, (x, _), response in pairs:
            turn = complex(dot(x, ux), dot(x, uy))
            for name, family in self.families_of(response).items():
                to = blend.setdefault(name, {h: [0] * len(coefs) for h, coefs in family.items()})
                for h, coefs in family.items():
                    to[h] = [old + weight * c * (turn ** h if h else 1) for old, c in zip(to[h], coefs)]
        return Law(blend, self.Z, self.X), ux, uy

    def distance(self, p):
        """From the contact surface; inside by the angle that it fills as seen from p."""
        nearest, angle = math.inf, 0.0
        for t in self.triangles:
            a, b, c = (sub(self.vertices[v], p) for v in t["vertex"])
            nearest = min(nearest, distance_to_triangle(a, b, c))
            la, lb, lc = (math.sqrt(dot(v, v)) for v in (a, b, c))
            angle += 2 * math.atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
        return -nearest if angle > 2 * math.pi else nearest


def distance_to_triangle(a, b, c):
    """Distance of the origin."""
    n = cross(sub(b, a), sub(c, a))
    edges = [(a, b), (b, c), (c, a)]
    if dot(n, n) > 0 and all(dot(cross(sub(q, p), mul(-1, p)), n) >= 0 for p, q in edges):
        return abs(dot(a, n)) / math.sqrt(dot(n, n))
    best = math.inf
    for p, q in edges:
        d = sub(q, p)
        share = max(0, min(1, -dot(p, d) / dot(d, d))) if dot(d, d) > 0 else 0
        at = add(p, mul(share, d))
        best = min(best, math.sqrt(dot(at, at)))
    return best


def is_level(curve):
    return curve[0] == curve[1] and curve[-1] == curve[-2]


def torque_tensors(t):
    """K and C of the fifteen numbers of BONDED_TORQUE at one depth."""
    xx, xy, yy, xn, yn, nn = t[3:9]
    return [[xx, xy, xn], [xy, yy, yn], [xn, yn, nn]], [list(t[9:12]), list(t[12:15])]


def is_positive(rows):
    rows = [list(row) for row in rows]
    for i in range(len(rows)):
        if not rows[i][i] > 0:
            return False
        for j in range(i + 1, len(rows)):
            share = rows[j][i] / rows[i][i]
            rows[j] = [b - share * a for a, b in zip(rows[i], rows[j])]
    return True


def stretch(a):
    """o / a and r / a."""
    if a <= 1:
        return 1, 1
    L = math.pi - 1
    t = (a - 1) / L
    return (1 + L * t - (1 + L) * t * t) / a, (1 + L * (t - t * t / 2)) / a


def left_jacobian(t):
    a = math.sqrt(dot(t, t))
    x = [[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]]
    once, twice = ((1 - math.cos(a)) / (a * a), (a - math.sin(a)) / a ** 3) if a else (1 / 2, 1 / 6)
    square = [[sum(x[i][k] * x[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    return [[(i == j) + once * x[i][j] + twice * square[i][j] for j in range(3)] for i in range(3)]


def transposed(m):
    return [list(column) for column in zip(*m)]


def solve(m, b):
    """Three equations, by Cramer's rule."""
    det = lambda a: dot(a[0], cross(a[1], a[2]))
    columns = transposed(m)
    return [det([b if i == j else columns[j] for j in range(3)]) / det(columns) for i in range(3)]


def spline_slope(coefs, u):
    """Slope of the cubic in the interval of u, from its differences: exact, because the fourth vanish."""
    m = len(coefs) - 3
    interval = min(int(m * u), m - 1)
    p = [spline(coefs, (interval + k / 3) / m - (1e-15 if k == 3 and interval + 1 < m else 0)) for k in range(4)]
    v = 3 * (m * u - interval)  # in thirds of the interval
    # Newton's form through v = 0, 1, 2, 3.
    d1, d2, d3 = p[1] - p[0], p[2] - 2 * p[1] + p[0], p[3] - 3 * p[2] + 3 * p[1] - p[0]
    return 3 * m * (d1 + d2 * (2 * v - 1) / 2 + d3 * (3 * v * v - 6 * v + 2) / 6)


def spline(coefs, u):
    """Cox and de Boor's recursion over all functions, not only those that are not zero."""
    n, m = len(coefs), len(coefs) - 3
    knots = [0, 0, 0] + [i / m for i in range(m + 1)] + [1, 1, 1]
    interval = 3 + min(int(m * u), m - 1)
    values = [1.0 if j == interval else 0.0 for j in range(n + 3)]
    for d in range(1, 4):
        part = lambda up, down: up / down if down else 0
        values = [part(u - knots[j], knots[j + d] - knots[j]) * values[j]
                  + part(knots[j + d + 1] - u, knots[j + d + 1] - knots[j + 1]) * values[j + 1]
                  for j in range(n + 3 - d)]
    return sum(c * v for c, v in zip(coefs, values))


def bernstein(coefs, s):
    n = len(coefs) - 1
    return sum(c * math.comb(n, i) * s ** i * (1 - s) ** (n - i) for i, c in enumerate(coefs))


def derivative(coefs):
    n = len(coefs) - 1
    return [n * (b - a) for a, b in zip(coefs, coefs[1:])] or [0]


def integral(coefs):
    sums = [0]
    for c in coefs:
        sums.append(sums[-1] + c / len(coefs))
    return sums


def second_harmonic(mean, h, u):
    """Product of the symmetric tensor of that mean and second harmonic with u."""
    return mean * u + h * u.conjugate()


def real_dot(a, b):
    return (a.conjugate() * b).real


class Law:
    """The blended response of one contact. Vectors of the tangent plane are complex numbers."""

    def __init__(self, blend, Z, X):
        self.blend, self.Z, self.X = blend, Z, X

    def force(self, z, e):
        """Normal force, tangential force on the tool and mu F at a depth z > 0 and a tangential deflection e (m)."""
        s, more = min(1, math.sqrt(z / self.Z)), max(0, z / self.Z - 1) / 2
        on = lambda coefs: bernstein(coefs, s) + more * bernstein(derivative(coefs), s)
        family = lambda name, h: self.blend.get(name, {}).get(h, [0])
        F, g = on(family("F", 0)), on(family("g", 1))
        slope = bernstein(derivative(family("g", 1)), s) / (2 * s * self.Z)
        if not self.X:
            return F + real_dot(slope, e), -g, math.inf
        u = e / self.X
        K = [on(integral(family("K'", h))) for h in (0, 2)]
        A = [bernstein(family("A", h), s) for h in (0, 2)]
        fn = F + real_dot(slope, e) + self.X / self.Z * real_dot(u, second_harmonic(*A, u)) / (4 * s)
        return fn, -(g + second_harmonic(*K, u)), bernstein(family("mu", 0), s) * F


def compare(folder):
    worst, lines = {}, 0
    for path in sorted(folder.glob("*.palp")):
        file = File(path.read_bytes())
        need(path.with_suffix(".forces").exists(), "%s: no .forces beside it" % path)
        for line in path.with_suffix(".forces").read_text().splitlines():
            asked, answered = (part.split() for part in line.split("="))
            word, a = asked[0], [float(x) for x in asked[1:]]
            answered = [float(x) for x in answered]
            where = (int(a[0]), a[1:4], int(a[4]), int(a[5]), a[6:9]) if word not in ("distance", "compliance") else ()
            tolerance = 1e-6
            if word == "force":
                now = file.force(*where, tuple(a[9:12]))
            elif word == "spun":
                now = file.force(*where, tuple(a[9:12]), a[12:21])
            elif word == "bonded":
                now = file.bonded_wrench(*where, tuple(a[9:12]))[:3]
            elif word == "torque":
                now = file.bonded_wrench(*where, tuple(a[9:12]), tuple(a[12:15]))
            elif word == "compliance":
                now = file.shared((int(a[0]), a[1:4]), (int(a[4]), a[5:8]))
            else:
                need(word == "distance", "unknown line: " + line)
                now = (file.distance(tuple(a)),)
            need(len(now) == len(answered), "answers of " + line)
            size = max((abs(x) for x in answered if math.isfinite(x)), default=0)
            for x, y in zip(now, answered):
                error = 0 if x == y else abs(x - y) / size if size else math.inf
                worst[path.stem, word] = max(worst.get((path.stem, word), 0), error)
                need(error <= tolerance, "%s: %s\ngot %s, off by %g" % (path.name, line, now, error))
            lines += 1
    need(lines > 0, "no golden in " + str(folder))
    for (name, word), error in worst.items():
        print("%-14s %-9s largest difference %.1e" % (name, word, error))
    print("%d lines agree" % lines)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    path = pathlib.Path(sys.argv[1])
    try:
        if path.is_dir():
            compare(path)
        else:
            fields = {k: v for k, v in vars(File(path.read_bytes())).items() if k not in ("data", "sections")}
            print(json.dumps(fields, indent=1))
    except (Bad, OSError) as error:
        sys.exit("%s: %s" % (path, error))


main()
