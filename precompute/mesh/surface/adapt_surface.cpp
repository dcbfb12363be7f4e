// SPDX-License-Identifier: GPL-3.0-or-later
// The rounds of adaptation, and the checks of what they led to.
#include "precompute/mesh/surface/adapt_surface.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/mesh/surface/surface_adapter.hpp"

#include <algorithm>
#include <limits>

namespace palpate::mesh {

using Eigen::Vector3d;

namespace {

// Middles of triangles lie 0.2 to 0.9 target lengths off the original, the most in creases; where the mesh folded or
// took another wall for its own, 4 to 10.
constexpr double kStray = 1.5;

struct Task {
  const geometry::SurfaceQuery& original;
  const SizeField& size;
  const std::vector<Vector3d>& anchors;
  const AdaptOptions& options;
};

void insert_anchors(SurfaceAdapter& adapter, const Task& task, AdaptedSurface& result) {
  result.anchors.clear();
  for (const Vector3d& a : task.anchors) result.anchors.push_back(adapter.insert_anchor(a));
}

// True when `result` got a surface that stays near the original and does not cross itself.
bool adapt_from(const Surface& start, bool coarse, const Task& task, AdaptedSurface& result) {
  SurfaceAdapter adapter(start, task.original, task.size, task.options.chord);
  if (coarse) {
    // An anchor on the original may lie far off the base: put into it at once, it would be a spike that folds.
    adapter.split_long();
    adapter.flip();
    adapter.relax();
  }
  insert_anchors(adapter, task, result);
  const auto round = [&] {
    adapter.split_long();
    adapter.collapse_short();
    adapter.flip();
    adapter.relax();
  };
  adapter.collapse_short();
  for (int k = 0; k < task.options.rounds; ++k) {
    // Not in the last round, whose splits would go without flips and relaxation after them.
    if (k >= 1 && k + 1 < task.options.rounds) adapter.shorten_where_coarse();
    round();
  }
  adapter.flip();
  for (int attempt = 0; attempt < 3; ++attempt) {
    result.surface = adapter.surface(result.anchors);
    if (adapter.largest_stray() > kStray) return false;
    const std::vector<std::int32_t> crossing = geometry::crossing_triangles(result.surface);
    if (crossing.empty()) return true;
    adapter.shorten(crossing, 0.5);
    round();
    adapter.flip();
  }
  return false;
}

}  // namespace

AdaptedSurface adapt_surface(const Surface& base, const geometry::SurfaceQuery& original, const SizeField& size,
                             const std::vector<Vector3d>& anchors, const AdaptOptions& options) {
  const double largest = options.largest > 0 ? options.largest : std::numeric_limits<double>::infinity();
  const SizeField capped = [&](const Vector3d& p) { return std::min(size(p), largest); };
  const Task task{original, capped, anchors, options};
  AdaptedSurface result;
  // A coarse base is quick; where it cuts off a sharp fold, points project to the wrong side of it. Coming down
  // from the original costs several times as much and never has to guess.
  if (adapt_from(base, true, task, result) || adapt_from(original.surface(), false, task, result)) return result;
  throw Error(ExitCode::numerical, "the remeshed surface strays from the one it stands for, or crosses itself");
}

}  // namespace palpate::mesh
