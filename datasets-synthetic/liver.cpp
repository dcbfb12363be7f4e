// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth union of ellipsoids, cut by a plane, with low waves; triangulated by an evened-out geodesic sphere.
#include "datasets-synthetic/liver.hpp"

#include "datasets-synthetic/random.hpp"
#include "datasets-synthetic/shapes.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace palpate::synth {

namespace {

/// Distance at which a ray from the origin leaves an ellipsoid around the origin.
double exit_distance(const Eigen::Vector3d& direction, const Eigen::Vector3d& centre,
                     const Eigen::Vector3d& semi_axes) {
  const Eigen::Vector3d d = direction.cwiseQuotient(semi_axes);
  const Eigen::Vector3d c = centre.cwiseQuotient(semi_axes);
  const double a = d.squaredNorm(), b = d.dot(c), e = c.squaredNorm() - 1;
  return (b + std::sqrt(b * b - a * e)) / a;
}

/// Area-weighted mean edge evening: vertices move towards their neighbours' mean and back to the surface.
void even_out(Surface& s, const LiverShape& shape, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    std::vector<Eigen::Vector3d> sum(s.vertices.size(), Eigen::Vector3d::Zero());
    std::vector<double> weight(s.vertices.size(), 0.0);
    for (const auto& [a, b, c] : s.triangles) {
      const Eigen::Vector3d& pa = s.vertices[static_cast<std::size_t>(a)];
      const Eigen::Vector3d& pb = s.vertices[static_cast<std::size_t>(b)];
      const Eigen::Vector3d& pc = s.vertices[static_cast<std::size_t>(c)];
      const double area = (pb - pa).cross(pc - pa).norm();
      const Eigen::Vector3d centre = (pa + pb + pc) / 3;
      for (const std::int32_t v : {a, b, c}) {
        sum[static_cast<std::size_t>(v)] += area * centre;
        weight[static_cast<std::size_t>(v)] += area;
      }
    }
    for (std::size_t v = 0; v < s.vertices.size(); ++v) {
      const Eigen::Vector3d direction = (0.5 * s.vertices[v] + 0.5 * sum[v] / weight[v]).normalized();
      s.vertices[v] = shape.radius(direction) * direction;
    }
  }
}

double area_of(const Surface& s) {
  double area = 0;
  for (const auto& [a, b, c] : s.triangles) {
    const Eigen::Vector3d& origin = s.vertices[static_cast<std::size_t>(a)];
    area += 0.5 * (s.vertices[static_cast<std::size_t>(b)] - origin)
                      .cross(s.vertices[static_cast<std::size_t>(c)] - origin)
                      .norm();
  }
  return area;
}

Surface triangulate(const LiverShape& shape, int frequency) {
  Surface s = geometry::geodesic_sphere(frequency, "liver");
  for (Eigen::Vector3d& v : s.vertices) v *= shape.radius(v);
  even_out(s, shape, 60);
  return s;
}

}  // namespace

LiverShape::LiverShape(std::uint64_t seed, double scale) {
  Random random(seed);
  // Right lobe, thin left lobe, small back lobe. The seed varies each measure by up to 6 %.
  const std::array<Lobe, 3> mean{{{{-0.025, 0, 0.004}, {0.055, 0.048, 0.038}},
                                  {{0.034, 0.006, -0.002}, {0.052, 0.036, 0.018}},
                                  {{-0.004, -0.022, -0.002}, {0.026, 0.038, 0.022}}}};
  for (std::size_t i = 0; i < mean.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      lobes_[i].centre[k] = scale * mean[i].centre[k] * random.uniform(0.94, 1.06);
      lobes_[i].semi_axes[k] = scale * mean[i].semi_axes[k] * random.uniform(0.94, 1.06);
    }
  }
  for (Wave& wave : waves_) {
    wave.direction = random.direction() * random.uniform(3.0, 6.0);
    wave.phase = random.uniform(0, 6.28);
    wave.height = random.uniform(0.002, 0.006);
  }
  depth_ = scale * 0.014;
}

double LiverShape::radius(const Eigen::Vector3d& direction) const {
  // p-norms: smooth, and within a few per cent of the largest (union) or smallest (cut) of the distances.
  constexpr double join = 14, cut = 10;
  double sum = 0;
  for (const Lobe& lobe : lobes_) sum += std::pow(exit_distance(direction, lobe.centre, lobe.semi_axes), join);
  double r = std::pow(sum, 1 / join);
  double wave_sum = 1;
  for (const Wave& wave : waves_) wave_sum += wave.height * std::cos(wave.direction.dot(direction) + wave.phase);
  r *= wave_sum;
  if (direction.z() < 0) r *= std::pow(1 + std::pow(r * -direction.z() / depth_, cut), -1 / cut);
  return r;
}

Surface liver_surface(const LiverShape& shape, double edge) {
  // The area is known once it is triangulated: once coarsely for the count.
  return triangulate(shape, geometry::geodesic_frequency(area_of(triangulate(shape, 10)), edge));
}

}  // namespace palpate::synth
