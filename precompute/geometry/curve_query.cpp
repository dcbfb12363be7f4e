// SPDX-License-Identifier: GPL-3.0-or-later
// Tangents at the ends of every piece, made once, and the tree.
#include "precompute/geometry/curve_query.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/cgal_mesh.hpp"

#include <CGAL/AABB_segment_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;
using Segments = std::vector<CgalKernel::Segment_3>;
using SegmentTree =
    CGAL::AABB_tree<CGAL::AABB_traits<CgalKernel, CGAL::AABB_segment_primitive<CgalKernel, Segments::const_iterator>>>;

using Ends = std::pair<Vector3d, Vector3d>;  // tangents at the ends of a piece

// Tangents at the ends of the pieces. Two pieces that meet are chords of a circle, whose tangent lies between them in
// the ratio of their lengths. At a loose end the circle goes on, and at a branching every piece keeps its own
// direction.
std::vector<Ends> end_tangents(const Curves& curves) {
  std::vector<std::vector<std::size_t>> at(curves.points.size());
  for (std::size_t k = 0; k < curves.pieces.size(); ++k) {
    for (const std::int32_t p : curves.pieces[k]) at[std::size_t(p)].push_back(k);
  }
  const auto along = [&](std::size_t k) -> Vector3d {
    return curves.points[std::size_t(curves.pieces[k][1])] - curves.points[std::size_t(curves.pieces[k][0])];
  };
  const auto inner = [&](std::size_t k, std::int32_t end) -> Vector3d {
    const auto& met = at[std::size_t(end)];
    const Vector3d mine = along(k);
    if (met.size() != 2) return {0, 0, 0};
    const std::size_t other = met[0] == k ? met[1] : met[0];
    // Both directions go the same way through the point.
    const bool leaves = curves.pieces[k][0] == end, other_leaves = curves.pieces[other][0] == end;
    const Vector3d theirs = leaves != other_leaves ? along(other) : Vector3d(-along(other));
    const Vector3d sum = mine.normalized() * theirs.norm() + theirs.normalized() * mine.norm();
    return sum.norm() > 1e-9 * mine.norm() ? sum.normalized() : mine.normalized();
  };
  std::vector<Ends> tangents;
  for (std::size_t k = 0; k < curves.pieces.size(); ++k) {
    const Vector3d direction = along(k).normalized();
    Ends ends{inner(k, curves.pieces[k][0]), inner(k, curves.pieces[k][1])};
    const auto close = [&](std::int32_t end, Vector3d& loose, const Vector3d& known) {
      if (!loose.isZero(0)) return;
      const bool branches = at[std::size_t(end)].size() > 2 || known.isZero(0);
      loose = branches ? direction : Vector3d(2 * direction.dot(known) * direction - known).normalized();
    };
    const Ends found = ends;
    close(curves.pieces[k][0], ends.first, found.second);
    close(curves.pieces[k][1], ends.second, found.first);
    tangents.push_back(ends);
  }
  return tangents;
}

}  // namespace

struct CurveQuery::Impl {
  explicit Impl(const Curves& source) : curves(source), tangents(end_tangents(curves)) {
    for (const auto& [a, b] : curves.pieces) {
      segments.emplace_back(to_cgal(curves.points[std::size_t(a)]), to_cgal(curves.points[std::size_t(b)]));
    }
    tree.insert(segments.cbegin(), segments.cend());
    tree.build();
    tree.accelerate_distance_queries();
    // The search structures finish on first use; that must not be a concurrent query.
    static_cast<void>(tree.closest_point_and_primitive(to_cgal(curves.points[0])));
  }
  Curves curves;
  std::vector<Ends> tangents;
  Segments segments;
  SegmentTree tree;
};

CurveQuery::CurveQuery(const Curves& curves) : impl_(std::make_unique<Impl>(curves)) {}
CurveQuery::~CurveQuery() = default;

const Curves& CurveQuery::curves() const noexcept { return impl_->curves; }

Vector3d CurveQuery::tangent(const Vector3d& point) const {
  if (!point.allFinite()) throw Error(ExitCode::numerical, "curve query at a point that is not finite");
  const auto found = impl_->tree.closest_point_and_primitive(to_cgal(point));
  const auto k = std::size_t(std::distance(impl_->segments.cbegin(), found.second));
  const auto& [a, b] = impl_->curves.pieces[k];
  const Vector3d from = impl_->curves.points[std::size_t(a)], along = impl_->curves.points[std::size_t(b)] - from;
  const double t = std::clamp((to_eigen(found.first) - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  const auto& [first, last] = impl_->tangents[k];
  const Vector3d turned = (1 - t) * first + t * last;
  return turned.norm() > 1e-6 ? turned.normalized() : along.normalized();
}

}  // namespace palpate::geometry
