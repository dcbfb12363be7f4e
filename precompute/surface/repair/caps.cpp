// SPDX-License-Identifier: GPL-3.0-or-later
// Flat rims: loops of border edges, their planes, nesting, and polygons with holes by bridges.
#include "precompute/surface/repair/caps.hpp"

#include "formats/surface/surface_plain.hpp"
#include "precompute/algebra/spectrum.hpp"
#include "precompute/geometry/topology.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace palpate::surface {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRoughness = 0.5;   // of the mean edge: a rim where whole triangles were left out is that jagged
constexpr double kFlatShare = 0.03;  // of the diagonal
constexpr std::size_t kLongestRim = 20000;  // edges; cutting ears takes the square of it

struct FlatRim {
  std::vector<std::int32_t> loop;
  std::int32_t part = 0;
  Vector3d centre{0, 0, 0}, normal{0, 0, 1};
  double deviation = 0, tolerance = 0, area = 0;
  int inside = -1;  ///< rim whose cap has this one as a hole
};

// Closed loops of border edges; where more than two meet in a vertex there is none.
std::vector<FlatRim> flat_rims(const Surface& surface) {
  const auto sides = geometry::sorted_sides(surface);
  std::map<std::int32_t, std::vector<std::int32_t>> next;
  std::map<std::int32_t, std::int32_t> part;
  geometry::for_each_edge(sides, [&](auto edge) {
    if (edge.size() != 1) return;
    next[edge[0].low].push_back(edge[0].high);
    next[edge[0].high].push_back(edge[0].low);
    part[edge[0].low] = surface.parts[std::size_t(edge[0].triangle)];
  });
  std::vector<FlatRim> rims;
  std::map<std::int32_t, bool> seen;
  for (const auto& [start, ends] : next) {
    if (seen[start] || ends.size() != 2) continue;
    FlatRim rim;
    std::int32_t before = -1, at = start;
    bool closed = false;
    while (!seen[at]) {
      seen[at] = true;
      rim.loop.push_back(at);
      if (part.contains(at)) rim.part = part.at(at);
      const auto& two = next.at(at);
      if (two.size() != 2) break;
      const auto onward = two[0] == before ? two[1] : two[0];
      before = at;
      at = onward;
      closed = at == start;
    }
    if (closed && rim.loop.size() >= 3 && rim.loop.size() <= kLongestRim) rims.push_back(std::move(rim));
  }
  return rims;
}

void fit_plane(const Surface& surface, FlatRim& rim) {
  const auto at = [&](std::size_t k) -> const Vector3d& {
    return surface.vertices[std::size_t(rim.loop[k % rim.loop.size()])];
  };
  double length = 0;
  for (std::size_t k = 0; k < rim.loop.size(); ++k) {
    rim.centre += at(k) / double(rim.loop.size());
    length += (at(k + 1) - at(k)).norm();
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Vector3d turn(0, 0, 0);
  for (std::size_t k = 0; k < rim.loop.size(); ++k) {
    spread += (at(k) - rim.centre) * (at(k) - rim.centre).transpose();
    turn += (at(k) - rim.centre).cross(at(k + 1) - rim.centre);
  }
  const auto eigen = algebra::spectrum<Eigen::Dynamic>(Eigen::MatrixXd(spread));
  rim.normal = eigen.vectors.col(0).normalized();
  if (turn.dot(rim.normal) < 0) {
    std::reverse(rim.loop.begin(), rim.loop.end());
    turn = -turn;
  }
  rim.area = turn.dot(rim.normal) / 2;
  rim.tolerance = kRoughness * length / double(rim.loop.size());
  for (std::size_t k = 0; k < rim.loop.size(); ++k) {
    rim.deviation = std::max(rim.deviation, std::abs((at(k) - rim.centre).dot(rim.normal)));
  }
}

class Plane {
public:
  Plane(const Surface& surface, const FlatRim& rim)
      : surface_(surface), centre_(rim.centre), u_(rim.normal.unitOrthogonal()), v_(rim.normal.cross(u_)) {}
  Vector2d flat(std::int32_t vertex) const {
    const Vector3d d = surface_.vertices[std::size_t(vertex)] - centre_;
    return {d.dot(u_), d.dot(v_)};
  }

private:
  const Surface& surface_;
  Vector3d centre_, u_, v_;
};

double cross(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool cross_properly(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  return cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0;
}

bool simple(const Plane& plane, const std::vector<std::int32_t>& loop) {
  if (loop.size() > 3000) return true;  // the triangulation decides
  std::vector<Vector2d> p;
  for (const auto v : loop) p.push_back(plane.flat(v));
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (std::size_t j = i + 2; j < p.size(); ++j) {
      if (cross_properly(p[i], p[(i + 1) % p.size()], p[j], p[(j + 1) % p.size()])) return false;
    }
  }
  return true;
}

bool contains(const Plane& plane, const std::vector<std::int32_t>& loop, const Vector2d& p) {
  bool in = false;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vector2d a = plane.flat(loop[k]), b = plane.flat(loop[(k + 1) % loop.size()]);
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      in = !in;
  }
  return in;
}

// Joins a hole (running the other way) to the outline by the shortest bridge that crosses nothing.
bool add_hole(const Plane& plane, std::vector<std::int32_t>& outline, const std::vector<std::int32_t>& hole) {
  struct Bridge {
    double length;
    std::size_t from, to;
  };
  std::vector<Bridge> bridges;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    for (std::size_t j = 0; j < hole.size(); ++j) {
      bridges.push_back({(plane.flat(outline[i]) - plane.flat(hole[j])).norm(), i, j});
    }
  }
  std::sort(bridges.begin(), bridges.end(), [](const Bridge& a, const Bridge& b) {
    return a.length != b.length ? a.length < b.length : a.from != b.from ? a.from < b.from : a.to < b.to;
  });
  for (const auto& [length, i, j] : bridges) {
    const Vector2d a = plane.flat(outline[i]), b = plane.flat(hole[j]);
    bool clear = true;
    for (const auto* loop : {static_cast<const std::vector<std::int32_t>*>(&outline), &hole}) {
      for (std::size_t k = 0; clear && k < loop->size(); ++k) {
        clear = !cross_properly(a, b, plane.flat((*loop)[k]), plane.flat((*loop)[(k + 1) % loop->size()]));
      }
    }
    if (!clear) continue;
    std::vector<std::int32_t> joined(outline.begin(), outline.begin() + std::ptrdiff_t(i) + 1);
    for (std::size_t k = 0; k <= hole.size(); ++k) joined.push_back(hole[(j + k) % hole.size()]);
    joined.insert(joined.end(), outline.begin() + std::ptrdiff_t(i), outline.end());
    outline = std::move(joined);
    return true;
  }
  return false;
}

}  // namespace

Surface cap_flat_rims(const Surface& surface, std::vector<std::string>& notes) {
  std::vector<FlatRim> rims = flat_rims(surface);
  const double size = geometry::diagonal(surface);
  for (FlatRim& rim : rims) fit_plane(surface, rim);
  std::erase_if(rims, [&](const FlatRim& rim) {
    return rim.deviation > std::max(1e-6 * size, std::min(rim.tolerance, kFlatShare * size)) ||
           !(rim.area > 1e-12 * size * size) || !simple(Plane(surface, rim), rim.loop);
  });
  std::sort(rims.begin(), rims.end(), [](const FlatRim& a, const FlatRim& b) {
    return a.area != b.area ? a.area > b.area : a.loop.front() < b.loop.front();
  });
  for (std::size_t k = 0; k < rims.size(); ++k) {
    for (std::size_t o = k; o-- > 0;) {  // the smallest that is larger
      if (rims[o].inside >= 0 || std::abs(rims[o].normal.dot(rims[k].normal)) < 0.98) continue;
      if (std::abs((rims[k].centre - rims[o].centre).dot(rims[o].normal)) > rims[o].tolerance + rims[k].tolerance)
        continue;
      const Plane plane(surface, rims[o]);
      if (!contains(plane, rims[o].loop, plane.flat(rims[k].loop.front()))) continue;
      rims[k].inside = int(o);
      break;
    }
  }
  Surface capped = surface;
  for (std::size_t k = 0; k < rims.size(); ++k) {
    if (rims[k].inside >= 0) continue;
    const Plane plane(surface, rims[k]);
    std::vector<std::int32_t> outline = rims[k].loop;
    double area = rims[k].area;
    std::size_t holes = 0;
    for (FlatRim& hole : rims) {
      if (hole.inside != int(k)) continue;
      if (hole.normal.dot(rims[k].normal) > 0) std::reverse(hole.loop.begin(), hole.loop.end());
      if (!add_hole(plane, outline, hole.loop)) continue;
      area -= hole.area;
      ++holes;
    }
    for (const auto& t : triangles_of(surface.vertices, outline.data(), outline.size())) {
      capped.triangles.push_back(t);
      capped.parts.push_back(rims[k].part);
    }
    notes.push_back(
        fmt::format("closed a flat rim of {} edges round ({:.4g}, {:.4g}, {:.4g}) m by a cap of {:.3g} cm2{}",
                    rims[k].loop.size(), rims[k].centre.x(), rims[k].centre.y(), rims[k].centre.z(), area * 1e4,
                    holes > 0 ? fmt::format(" with {} holes", holes) : ""));
  }
  return capped;
}

}  // namespace palpate::surface
