// SPDX-License-Identifier: GPL-3.0-or-later
// Bending is a shear, z - bend x^2: it keeps the surface closed and free of crossings, and the volume as it is.
#include "datasets-synthetic/kidney.hpp"

#include "precompute/geometry/solids.hpp"

#include <cmath>

namespace palpate::synth {
namespace {

const Eigen::Vector3d kSemiAxes(0.055, 0.02, 0.0275);  // m
constexpr double kBend = 8.0;                          // 1/m; beyond 4.5 the underside is hollow
constexpr double kCortex = 0.007;                      // m over a pyramid
const Eigen::Vector3d kPyramid(0.0045, 0.007, 0.008);  // m, semi-axes

}  // namespace

Surface KidneyShape::surface(double edge) const {
  Surface s = geometry::ellipsoid({0, 0, 0}, scale_ * kSemiAxes, edge, "kidney");
  for (Eigen::Vector3d& v : s.vertices) v.z() -= kBend / scale_ * v.x() * v.x();
  return s;
}

double KidneyShape::underside() const { return -0.85 * scale_ * kSemiAxes.z(); }

std::vector<KidneyShape::Pyramid> KidneyShape::pyramids() const {
  std::vector<Pyramid> pyramids;
  for (const double x : {-0.0325, -0.0195, -0.0065, 0.0065, 0.0195, 0.0325}) {
    const double top = kSemiAxes.z() * std::sqrt(1 - std::pow(x / kSemiAxes.x(), 2));
    pyramids.push_back(
        {scale_ * Eigen::Vector3d(x, 0, top - kCortex - kPyramid.z() - kBend * x * x), scale_ * kPyramid});
  }
  return pyramids;
}

}  // namespace palpate::synth
