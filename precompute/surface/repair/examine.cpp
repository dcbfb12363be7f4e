// SPDX-License-Identifier: GPL-3.0-or-later
// Validation of a surface, and how its faults are put in words.
#include "precompute/surface/repair/examine.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/surface/repair/weld.hpp"

#include <fmt/format.h>

namespace palpate::surface {

bool SurfaceFaults::clean() const noexcept { return topology.closed_manifold() && crossings == 0 && volume > 0.0; }

std::vector<std::string> SurfaceFaults::lines() const {
  std::vector<std::string> result;
  const auto add = [&](std::size_t count, const char* text) {
    if (count > 0) result.push_back(fmt::format(fmt::runtime(text), count));
  };
  add(topology.degenerate, "{} triangles without area");
  add(topology.duplicates, "{} triangles that double another");
  if (topology.boundary_edges > 0) {
    result.push_back(
        fmt::format("open: {} boundary edges in {} loops", topology.boundary_edges, topology.boundary_loops));
  }
  add(topology.nonmanifold_edges, "{} edges with more than two triangles");
  add(topology.nonmanifold_vertices, "{} vertices where sheets touch in a point");
  add(topology.flipped_edges, "{} edges whose triangles face opposite ways");
  add(crossings, "self-intersecting: {} pairs of triangles");
  if (topology.closed_manifold() && volume < 0.0) {
    result.push_back(fmt::format("inside out: its volume is {:.4g} mL", volume * 1e6));
  }
  if (topology.closed_manifold() && volume == 0.0) result.emplace_back("flat: it holds no volume");
  if (topology.components > 1) result.push_back(fmt::format("{} separate components", topology.components));
  return result;
}

void require_usable(const Surface& surface, const std::string& name) {
  const auto fail = [&](const std::string& cause) { throw Error(ExitCode::bad_input, name + ": " + cause); };
  if (surface.empty()) fail("there are no triangles");
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    if (!surface.vertices[v].allFinite()) fail(fmt::format("vertex {}: a coordinate is NaN or infinite", v));
  }
  if (surface.parts.size() != surface.triangles.size()) fail("not every triangle has a part");
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const auto vertex : surface.triangles[t]) {
      if (vertex < 0 || std::size_t(vertex) >= surface.vertices.size()) {
        fail(fmt::format("triangle {}: vertex index {} is outside 0..{}", t, vertex, surface.vertices.size() - 1));
      }
    }
    if (surface.parts[t] < 0 || std::size_t(surface.parts[t]) >= surface.part_names.size()) {
      fail(fmt::format("triangle {}: part {} is outside 0..{}", t, surface.parts[t], surface.part_names.size()));
    }
  }
  if (!(geometry::diagonal(surface) > 0.0)) fail("all points are at one place");
}

SurfaceFaults examine(const Surface& surface) {
  SurfaceFaults faults;
  faults.topology = geometry::topology(surface);
  const Surface welded = weld(surface, 0.0);
  if (faults.topology.closed_manifold()) {
    // Closed parts with a wall or an edge in common: a copy, or two organs that share their border.
    const geometry::Topology touching = geometry::topology(welded);
    faults.topology.duplicates = touching.duplicates;
    faults.topology.nonmanifold_edges = touching.nonmanifold_edges;
  }
  // Triangles that meet in equal points without sharing an index touch; that is openness, not a crossing.
  faults.crossings = geometry::crossings(drop_duplicates(welded)).size();
  faults.volume = geometry::signed_volume(surface);
  const double size = geometry::diagonal(surface);
  if (std::abs(faults.volume) < 1e-12 * size * size * size) faults.volume = 0.0;
  return faults;
}

std::string joined(const std::vector<std::string>& lines) { return fmt::format("{}", fmt::join(lines, "; ")); }

}  // namespace palpate::surface
