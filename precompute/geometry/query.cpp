// SPDX-License-Identifier: GPL-3.0-or-later
// SurfaceQuery over a CGAL AABB tree, built whole in the constructor so that queries only read.
#include "precompute/geometry/query.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/cgal_mesh.hpp"
#include "precompute/geometry/feature_normals.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;
using Kernel = CgalKernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

// Integral of the unit bump (1 - r^2/R^2)^2 round `centre` over a triangle, by halving its longest edge.
double bump_area(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& centre, double radius) {
  const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
  const double longest = std::max({ab, bc, ca});
  const Vector3d middle = (a + b + c) / 3;
  const double away = (middle - centre).norm();
  if (away - longest >= radius) return 0;
  if (longest <= radius / 3) {
    const double q = away / radius;
    return q < 1 ? 0.5 * (b - a).cross(c - a).norm() * (1 - q * q) * (1 - q * q) : 0;
  }
  if (ab == longest) {
    const Vector3d m = (a + b) / 2;
    return bump_area(a, m, c, centre, radius) + bump_area(m, b, c, centre, radius);
  }
  if (bc == longest) {
    const Vector3d m = (b + c) / 2;
    return bump_area(b, m, a, centre, radius) + bump_area(m, c, a, centre, radius);
  }
  const Vector3d m = (c + a) / 2;
  return bump_area(c, m, b, centre, radius) + bump_area(m, a, b, centre, radius);
}

}  // namespace

struct SurfaceQuery::Impl {
  explicit Impl(const Surface& source) : surface(source), normals(surface) {
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
      // A triangle without area adds nothing: its neighbours carry its edges.
      if (normals.face(static_cast<std::int32_t>(i)).isZero(0)) continue;
      ids.push_back(static_cast<std::int32_t>(i));
      const auto& t = surface.triangles[i];
      triangles.emplace_back(to_cgal(surface.vertices[t[0]]), to_cgal(surface.vertices[t[1]]),
                             to_cgal(surface.vertices[t[2]]));
      for (const std::int32_t v : t) bounds.extend(surface.vertices[v]);
    }
    features = normals.sharp_lines(surface, kFeatureAngle, kFeatureLength * bounds.diagonal().norm());
    if (ids.empty()) throw Error(ExitCode::bad_input, "surface has no triangle with an area above 0");
    tree.insert(triangles.cbegin(), triangles.cend());
    tree.build();
    tree.accelerate_distance_queries();
    // The search structures finish on first use; that must not be a concurrent query.
    static_cast<void>(tree.closest_point_and_primitive(to_cgal(surface.vertices[0])));
  }

  [[nodiscard]] std::int32_t id(Triangles::const_iterator at) const {
    return ids[std::distance(triangles.begin(), at)];
  }

  // Closest triangle, then the point on it by its Voronoi regions, which also distinguish edges from faces.
  [[nodiscard]] std::pair<std::int32_t, TrianglePoint> closest(const Vector3d& p) const {
    if (!p.allFinite()) throw Error(ExitCode::numerical, "surface query at a point that is not finite");
    const auto found = tree.closest_point_and_primitive(to_cgal(p));
    const std::int32_t triangle = id(found.second);
    const auto& t = surface.triangles[triangle];
    return {triangle, closest_on_triangle(p, surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]])};
  }

  struct Hit {
    double distance;
    std::int32_t triangle;
  };
  // First hit beyond `skip`; triangles for which `ignore` holds do not count.
  template <class Ignore>
  [[nodiscard]] std::optional<Hit> first_hit(const Vector3d& origin, const Vector3d& direction, double skip,
                                             const Ignore& ignore) const {
    if (!origin.allFinite() || !(direction.squaredNorm() > 0)) {
      throw Error(ExitCode::numerical, "ray query with an origin or a direction that is not finite or zero");
    }
    const Vector3d start = origin + skip * direction;
    const Kernel::Ray_3 ray(to_cgal(start), Kernel::Vector_3(direction.x(), direction.y(), direction.z()));
    const auto hit = tree.first_intersection(ray, [&](Triangles::const_iterator at) { return ignore(id(at)); });
    if (!hit) return std::nullopt;
    const auto along = [&](const Kernel::Point_3& p) { return (to_eigen(p) - origin).dot(direction); };
    double distance = 0;
    if (const auto* point = boost::get<Kernel::Point_3>(&hit->first)) {
      distance = along(*point);
    } else if (const auto* segment = boost::get<Kernel::Segment_3>(&hit->first)) {
      distance = std::min(along(segment->source()), along(segment->target()));
    }
    return Hit{std::max(distance, skip), id(hit->second)};
  }

  Surface surface;
  FeatureNormals normals;
  std::vector<std::array<std::int32_t, 2>> features;
  std::vector<std::int32_t> ids;  // index in the surface of each triangle of the tree
  Triangles triangles;
  Tree tree;
  Eigen::AlignedBox3d bounds;
};

SurfaceQuery::SurfaceQuery(const Surface& surface) : impl_(std::make_unique<Impl>(surface)) {}
SurfaceQuery::~SurfaceQuery() = default;
SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;
SurfaceQuery& SurfaceQuery::operator=(SurfaceQuery&&) noexcept = default;

const Surface& SurfaceQuery::surface() const noexcept { return impl_->surface; }

ClosestPoint SurfaceQuery::closest(const Vector3d& point) const {
  const auto [triangle, on] = impl_->closest(point);
  return {on.point, triangle, (point - on.point).norm()};
}

std::optional<double> SurfaceQuery::ray(const Vector3d& origin, const Vector3d& direction, double skip) const {
  const auto hit = impl_->first_hit(origin, direction, skip, [](std::int32_t) { return false; });
  return hit ? std::optional(hit->distance) : std::nullopt;
}

double SurfaceQuery::signed_distance(const Vector3d& point) const {
  const auto [triangle, on] = impl_->closest(point);
  const Vector3d away = point - on.point;
  const double distance = away.norm();
  return away.dot(impl_->normals.at(triangle, on.weights)) < 0 ? -distance : distance;
}

double SurfaceQuery::thickness(const Vector3d& point, const Vector3d& normal) const {
  const Vector3d inward = -normal.normalized();
  const Vector3d u = inward.unitOrthogonal(), v = inward.cross(u);
  const double diagonal = impl_->bounds.diagonal().norm(), skip = 1e-6 * diagonal;
  double thinnest = diagonal;
  const auto shoot = [&](double tilt, double turn) {
    const Vector3d direction = std::cos(tilt) * inward + std::sin(tilt) * (std::cos(turn) * u + std::sin(turn) * v);
    // From inside, only the back of a wall can be hit; and only a wall that faces the point is the opposite one
    // (else the side of a box would make its rim thin).
    const auto hit = impl_->first_hit(point, direction, skip, [&](std::int32_t triangle) {
      return impl_->normals.face(triangle).dot(direction) <= 0;
    });
    if (hit && impl_->normals.face(hit->triangle).dot(inward) > 0.5) thinnest = std::min(thinnest, hit->distance);
  };
  constexpr double degree = std::numbers::pi / 180;
  shoot(0, 0);
  for (int k = 0; k < 4; ++k) shoot(7.5 * degree, 90 * k * degree);
  for (int k = 0; k < 8; ++k) shoot(15 * degree, 45 * k * degree);
  return thinnest;
}

Vector3d SurfaceQuery::normal(const Vector3d& point, double radius) const {
  const auto [closest, on] = impl_->closest(point);
  const Vector3d& here = impl_->normals.face(closest);
  if (!(radius > 0)) return here;
  std::vector<Triangles::const_iterator> near;
  const Vector3d low = on.point.array() - radius, high = on.point.array() + radius;
  impl_->tree.all_intersected_primitives(Kernel::Iso_cuboid_3(to_cgal(low), to_cgal(high)), std::back_inserter(near));
  Vector3d sum = Vector3d::Zero();
  for (const Triangles::const_iterator& at : near) {
    const Vector3d& n = impl_->normals.face(impl_->id(at));
    // The far wall of a thin part is near in space only.
    if (n.dot(here) < -0.3) continue;
    sum += bump_area(to_eigen(at->vertex(0)), to_eigen(at->vertex(1)), to_eigen(at->vertex(2)), on.point, radius) * n;
  }
  const double length = sum.norm();
  return length > 0 ? Vector3d(sum / length) : here;
}

const std::vector<std::array<std::int32_t, 2>>& SurfaceQuery::feature_edges() const noexcept { return impl_->features; }

std::optional<Vector3d> SurfaceQuery::closest_on_feature(const Vector3d& point) const {
  std::optional<Vector3d> best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : impl_->features) {
    const Vector3d& a = impl_->surface.vertices[from];
    const Vector3d along = impl_->surface.vertices[to] - a;
    const Vector3d on = a + std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
    if (const double d = (point - on).squaredNorm(); d < least) {
      least = d;
      best = on;
    }
  }
  return best;
}

}  // namespace palpate::geometry
