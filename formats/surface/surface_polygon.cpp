// SPDX-License-Identifier: MIT
// Triangulation of one polygon by cutting ears (Meisters 1975), in the plane of its area vector.
#include "formats/surface/surface_plain.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool inside(const Vector2d& p, const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

}  // namespace

std::vector<std::array<std::int32_t, 3>> triangles_of(const std::vector<Vector3d>& vertices,
                                                      const std::int32_t* corners, std::size_t count) {
  std::vector<std::array<std::int32_t, 3>> result;
  const auto fan = [&] {
    result.clear();
    for (std::size_t k = 2; k < count; ++k) result.push_back({corners[0], corners[k - 1], corners[k]});
    return result;
  };
  if (count == 3) return fan();
  const auto at = [&](std::size_t k) -> const Vector3d& { return vertices[std::size_t(corners[k % count])]; };
  Vector3d normal(0, 0, 0);  // twice the area vector (Newell)
  for (std::size_t k = 0; k < count; ++k) normal += (at(k) - at(0)).cross(at(k + 1) - at(0));
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length)) return fan();
  normal /= length;
  const Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Vector2d> flat;
  for (std::size_t k = 0; k < count; ++k) flat.emplace_back((at(k) - at(0)).dot(u), (at(k) - at(0)).dot(v));
  const double tolerance = 1e-12 * length;
  bool convex = true;
  for (std::size_t k = 0; k < count && convex; ++k) {
    convex = turn(flat[k], flat[(k + 1) % count], flat[(k + 2) % count]) >= -tolerance;
  }
  if (convex) return fan();
  std::vector<std::size_t> left(count);
  for (std::size_t k = 0; k < count; ++k) left[k] = k;
  std::size_t at_corner = 0, failed = 0;
  while (left.size() > 3) {
    if (failed > left.size()) return fan();  // it crosses itself
    const std::size_t n = left.size();
    const std::size_t a = left[(at_corner + n - 1) % n], b = left[at_corner % n], c = left[(at_corner + 1) % n];
    bool ear = turn(flat[a], flat[b], flat[c]) > 0;
    for (std::size_t k = 0; ear && k < n; ++k) {
      const std::size_t p = left[k];
      if (p == a || p == b || p == c || corners[p] == corners[a] || corners[p] == corners[b] ||
          corners[p] == corners[c])
        continue;
      ear = !inside(flat[p], flat[a], flat[b], flat[c]);
    }
    if (!ear) {
      // A corner on a straight line is no ear, but may go when nothing else does.
      ++failed;
      at_corner = (at_corner + 1) % n;
      continue;
    }
    failed = 0;
    result.push_back({corners[a], corners[b], corners[c]});
    left.erase(left.begin() + std::ptrdiff_t(at_corner % n));
    at_corner = left.empty() ? 0 : at_corner % left.size();
  }
  result.push_back({corners[left[0]], corners[left[1]], corners[left[2]]});
  return result;
}

Frame stated_frame(std::string_view comment) {
  if (comment.find("SPACE=LPS") != std::string_view::npos) return Frame::lps;
  if (comment.find("SPACE=RAS") != std::string_view::npos) return Frame::ras;
  return Frame::unstated;
}

}  // namespace palpate
