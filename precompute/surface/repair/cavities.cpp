// SPDX-License-Identifier: GPL-3.0-or-later
// The wall of a cavity encloses a negative volume.
#include "precompute/surface/repair/cavities.hpp"

#include "precompute/geometry/topology.hpp"
#include "precompute/surface/repair/weld.hpp"

#include <algorithm>

namespace palpate::surface {

std::vector<char> cavity_triangles(const Surface& surface) {
  const auto labels = geometry::triangle_components(surface, true);
  const auto count = labels.empty() ? 0 : *std::max_element(labels.begin(), labels.end()) + 1;
  std::vector<char> walls;
  for (std::int32_t k = 0; count > 1 && k < count; ++k) {
    std::vector<bool> in(labels.size());
    for (std::size_t t = 0; t < labels.size(); ++t) in[t] = labels[t] == k;
    if (geometry::signed_volume(keep_triangles(surface, in)) > 0) continue;
    walls.resize(labels.size(), 0);
    for (std::size_t t = 0; t < labels.size(); ++t) {
      if (in[t]) walls[t] = 1;
    }
  }
  return walls;
}

}  // namespace palpate::surface
