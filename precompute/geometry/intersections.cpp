// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL finds overlapping boxes and decides pairs of triangles; what neighbours may share is decided here.
#include "precompute/geometry/intersections.hpp"

#include "precompute/geometry/cgal_mesh.hpp"
#include "precompute/geometry/topology.hpp"

#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <utility>

namespace palpate::geometry {
namespace {

using Triangle = CgalKernel::Triangle_3;
using Segment = CgalKernel::Segment_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;

CgalKernel::Point_3 point(const Surface& surface, std::int32_t vertex) {
  return to_cgal(surface.vertices[std::size_t(vertex)]);
}

Triangle triangle(const Surface& surface, std::int32_t number) {
  const auto& t = surface.triangles[std::size_t(number)];
  return {point(surface, t[0]), point(surface, t[1]), point(surface, t[2])};
}

std::vector<Box> boxes(const Surface& surface) {
  std::vector<Box> result;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    if (is_degenerate(surface, i)) continue;
    result.emplace_back(triangle(surface, std::int32_t(i)).bbox(), std::int32_t(i));
  }
  return result;
}

// Whether two triangles of one surface meet anywhere but in what they share by index.
bool cross(const Surface& surface, std::int32_t a, std::int32_t b) {
  auto s = surface.triangles[std::size_t(a)], t = surface.triangles[std::size_t(b)];
  // Shared corners to the front, in the same order in both.
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = std::find(t.begin() + std::ptrdiff_t(shared), t.end(), s[i]);
    if (found == t.end()) continue;
    std::swap(t[shared], *found);
    std::swap(s[shared], s[i]);
    ++shared;
  }
  if (shared == 0) return CGAL::do_intersect(triangle(surface, a), triangle(surface, b));
  if (shared == 3) return true;
  const auto p = [&](std::int32_t v) { return point(surface, v); };
  if (shared == 2) {
    return CGAL::coplanar(p(s[0]), p(s[1]), p(s[2]), p(t[2])) &&
           CGAL::coplanar_orientation(p(s[0]), p(s[1]), p(s[2]), p(t[2])) == CGAL::POSITIVE;
  }
  return CGAL::do_intersect(Segment(p(s[1]), p(s[2])), triangle(surface, b)) ||
         CGAL::do_intersect(Segment(p(t[1]), p(t[2])), triangle(surface, a));
}

// Calls visit(a, b) for the pairs that cross, in no order, until it returns false.
template <class Visit>
void visit_crossings(const Surface& surface, Visit visit) {
  auto all = boxes(surface);
  bool on = true;
  CGAL::box_self_intersection_d(all.begin(), all.end(), [&](const Box& a, const Box& b) {
    if (on && cross(surface, a.info(), b.info())) on = visit(a.info(), b.info());
  });
}

// The same for a triangle of one surface and one of the other.
template <class Visit>
void visit_crossings(const Surface& a, const Surface& b, Visit visit) {
  auto first = boxes(a), second = boxes(b);
  bool on = true;
  CGAL::box_intersection_d(first.begin(), first.end(), second.begin(), second.end(), [&](const Box& s, const Box& t) {
    if (on && CGAL::do_intersect(triangle(a, s.info()), triangle(b, t.info()))) on = visit(s.info(), t.info());
  });
}

}  // namespace

std::vector<std::array<std::int32_t, 2>> crossings(const Surface& surface) {
  std::vector<std::array<std::int32_t, 2>> pairs;
  visit_crossings(surface, [&](std::int32_t a, std::int32_t b) {
    pairs.push_back({std::min(a, b), std::max(a, b)});
    return true;
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::size_t crossings(const Surface& a, const Surface& b) {
  std::size_t count = 0;
  visit_crossings(a, b, [&](std::int32_t, std::int32_t) {
    ++count;
    return true;
  });
  return count;
}

std::vector<std::int32_t> crossing_triangles(const Surface& surface) {
  std::vector<std::int32_t> triangles;
  for (const auto& pair : crossings(surface)) triangles.insert(triangles.end(), pair.begin(), pair.end());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (is_degenerate(surface, t)) triangles.push_back(std::int32_t(t));
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

bool self_intersects(const Surface& surface) {
  static_cast<void>(to_cgal_mesh(surface));  // refuses what is no manifold
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (is_degenerate(surface, t)) return true;
  }
  bool found = false;
  visit_crossings(surface, [&](std::int32_t, std::int32_t) {
    found = true;
    return false;
  });
  return found;
}

bool surfaces_intersect(const Surface& first, const Surface& second) {
  bool found = false;
  visit_crossings(first, second, [&](std::int32_t, std::int32_t) {
    found = true;
    return false;
  });
  return found;
}

}  // namespace palpate::geometry
