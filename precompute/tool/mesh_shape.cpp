// SPDX-License-Identifier: GPL-3.0-or-later
// The lattice is filled once, in a band about the surface; evaluations then read 64 values.
#include "precompute/tool/mesh_shape.hpp"

#include "formats/io/error.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace palpate::tool {
namespace {

using Eigen::Vector3d;

constexpr double kMostPoints = 2e7;
// Share of the rounding: the weights reach two spacings to either side, so that faces are flat up to the rounding from
// an edge (at twice this a block of 20 roundings lost 9 % of its force at a depth of a tenth of the rounding).
constexpr double kSpacing = 0.5;
// In spacings: how near a lattice point has to be to the surface for its cell to be smoothed, and the band of exact
// values that this takes: to a place beside that point and across the diagonal of the 64 round it.
constexpr double kSmoothed = 3, kBand = kSmoothed + 0.87 + 3.47;
// The weights' mean distance from their place is at most this: so far the smoothed value may be below the exact one.
constexpr double kSpread = 1.0;

// Weights of four neighbours at 0 <= t <= 1 between the middle two, with derivatives.
struct Weights {
  explicit Weights(double t) {
    const double s = 1 - t;
    value = {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
    first = {-s * s / 2, (3 * t * t - 4 * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2};
    second = {s, 3 * t - 2, 3 * s - 2, t};
  }
  std::array<double, 4> value, first, second;
};

}  // namespace

MeshShape::MeshShape(const Surface& surface, double rounding) : query_(surface), spacing_(kSpacing * rounding) {
  for (const Vector3d& v : surface.vertices) bounds_.extend(v);
  const double margin = kBand * spacing_;
  origin_ = bounds_.min() - Vector3d::Constant(margin);
  double points = 1;
  for (int k = 0; k < 3; ++k) {
    const double along = std::ceil((bounds_.sizes()[k] + 2 * margin) / spacing_) + 1;
    points *= along;
    if (points > kMostPoints) break;
    size_[std::size_t(k)] = static_cast<std::ptrdiff_t>(along);
  }
  if (points > kMostPoints) {
    throw Error(ExitCode::bad_input, "tool.edge_radius: " + std::to_string(rounding) + " m is too fine for a tool of " +
                                         std::to_string(bounds_.diagonal().norm()) + " m; allowed about " +
                                         std::to_string(std::cbrt(bounds_.volume() / kMostPoints) / kSpacing) +
                                         " m and more");
  }
  fill();
}

void MeshShape::fill() {
  const auto [nx, ny, nz] = size_;
  values_.resize(std::size_t(nx * ny * nz));
  const double band = kBand * spacing_;
  for (std::ptrdiff_t k = 0; k < nz; ++k) {
    for (std::ptrdiff_t j = 0; j < ny; ++j) {
      for (std::ptrdiff_t i = 0; i < nx;) {
        const double d = query_.signed_distance(origin_ + spacing_ * Vector3d(double(i), double(j), double(k)));
        // A distance changes by no more than the way: up to the band the next points need only a bound.
        const double away = std::max(std::abs(d) - band, 0.0);
        const std::ptrdiff_t end = std::min(nx, i + 1 + static_cast<std::ptrdiff_t>(away / spacing_));
        for (std::ptrdiff_t at = i; at < end; ++at) {
          values_[std::size_t((k * ny + j) * nx + at)] = d - double(at - i) * spacing_;
        }
        i = end;
      }
    }
  }
}

double MeshShape::lower_bound(const Vector3d& p) const {
  const Vector3d at = (p - origin_) / spacing_;
  std::array<std::ptrdiff_t, 3> node{};
  for (int k = 0; k < 3; ++k) {
    const double nearest = std::round(at[k]);
    if (!(nearest >= 0 && nearest < double(size_[std::size_t(k)]))) return bounds_.exteriorDistance(p);
    node[std::size_t(k)] = static_cast<std::ptrdiff_t>(nearest);
  }
  const double off = spacing_ * (at - Vector3d(double(node[0]), double(node[1]), double(node[2]))).norm();
  const double near = values_[std::size_t((node[2] * size_[1] + node[1]) * size_[0] + node[0])];
  return near - off - (std::abs(near) > kSmoothed * spacing_ ? 0.0 : kSpread * spacing_);
}

// Exact distance of a point at least the lattice's spacing from the surface; the lattice gives its side.
DistanceSample MeshShape::exact(const Vector3d& p, bool inside) const {
  const geometry::ClosestPoint nearest = query_.closest(p);
  const double sign = inside ? -1.0 : 1.0;
  DistanceSample s;
  s.value = sign * nearest.distance;
  s.gradient = sign * (p - nearest.point) / nearest.distance;
  return s;
}

DistanceSample MeshShape::distance(const Vector3d& p) const {
  const Vector3d at = (p - origin_) / spacing_;
  std::array<std::ptrdiff_t, 3> first{}, nearest{};
  for (int k = 0; k < 3; ++k) {
    const double cell = std::floor(at[k]);
    if (!(cell >= 1 && cell + 2 < double(size_[std::size_t(k)]))) return exact(p, false);
    first[std::size_t(k)] = static_cast<std::ptrdiff_t>(cell) - 1;
    nearest[std::size_t(k)] = static_cast<std::ptrdiff_t>(std::round(at[k]));
  }
  const double near = values_[std::size_t((nearest[2] * size_[1] + nearest[1]) * size_[0] + nearest[0])];
  if (std::abs(near) > kSmoothed * spacing_) return exact(p, near < 0);
  const Weights x(at.x() - double(first[0] + 1)), y(at.y() - double(first[1] + 1)), z(at.z() - double(first[2] + 1));
  double value = 0;
  Vector3d slope = Vector3d::Zero(), bend = Vector3d::Zero(),
           twist = Vector3d::Zero();  // bend: xx, yy, zz; twist: yz, zx, xy
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const double* row = values_.data() +
                          ((first[2] + std::ptrdiff_t(k)) * size_[1] + first[1] + std::ptrdiff_t(j)) * size_[0] +
                          first[0];
      double a = 0, b = 0, c = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        a += x.value[i] * row[i];
        b += x.first[i] * row[i];
        c += x.second[i] * row[i];
      }
      value += z.value[k] * y.value[j] * a;
      slope += Vector3d(z.value[k] * y.value[j] * b, z.value[k] * y.first[j] * a, z.first[k] * y.value[j] * a);
      bend += Vector3d(z.value[k] * y.value[j] * c, z.value[k] * y.second[j] * a, z.second[k] * y.value[j] * a);
      twist += Vector3d(z.first[k] * y.first[j] * a, z.first[k] * y.value[j] * b, z.value[k] * y.first[j] * b);
    }
  }
  DistanceSample s;
  s.value = value;
  s.gradient = slope / spacing_;
  s.hessian << bend.x(), twist.z(), twist.y(), twist.z(), bend.y(), twist.x(), twist.y(), twist.x(), bend.z();
  s.hessian /= spacing_ * spacing_;
  return s;
}

}  // namespace palpate::tool
