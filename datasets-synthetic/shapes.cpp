// SPDX-License-Identifier: GPL-3.0-or-later
// Slabs, and instruments as surfaces of revolution.
#include "datasets-synthetic/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::synth {

using std::numbers::pi;

Surface box(const Eigen::Vector3d& size, double edge, const std::string& name) {
  return geometry::box_solid({-size.x() / 2, -size.y() / 2, -size.z()}, {size.x() / 2, size.y() / 2, 0}, edge, name);
}

Surface sphere_tool(double radius) {
  Surface s = geometry::geodesic_sphere(8, "sphere");
  for (Eigen::Vector3d& v : s.vertices) v *= radius;
  return s;
}

Surface capsule_tool(double radius, double length) {
  constexpr int segments = 32, cap_rings = 8;
  std::vector<geometry::ProfilePoint> profile{{0, -radius}};
  for (int i = 1; i <= cap_rings; ++i) {
    const double angle = pi / 2 * i / cap_rings;
    profile.push_back({radius * std::sin(angle), -radius * std::cos(angle)});
  }
  const int stem_rings = std::max(1, static_cast<int>(std::lround(length / (2 * pi * radius / segments))));
  for (int i = 1; i <= stem_rings; ++i) profile.push_back({radius, length * i / stem_rings});
  for (int i = cap_rings - 1; i >= 1; --i) {
    const double angle = pi / 2 * i / cap_rings;
    profile.push_back({radius * std::sin(angle), length + radius * std::cos(angle)});
  }
  profile.push_back({0, length + radius});
  return geometry::revolved(profile, segments, "capsule");
}

Surface stylus_tool(double tip_radius, double shaft_radius, double length) {
  constexpr int segments = 32, tip_rings = 8;
  // A cone of 20 degrees to the axis touches the tip sphere where the sphere's normal has that angle to the horizon.
  const double half_angle = pi / 9;
  std::vector<geometry::ProfilePoint> profile{{0, -tip_radius}};
  for (int i = 1; i <= tip_rings; ++i) {
    const double angle = (pi / 2 - half_angle) * i / tip_rings;
    profile.push_back({tip_radius * std::sin(angle), -tip_radius * std::cos(angle)});
  }
  const geometry::ProfilePoint joint = profile.back();
  const double cone_height = (shaft_radius - joint.radius) / std::tan(half_angle);
  constexpr int cone_rings = 6;
  for (int i = 1; i <= cone_rings; ++i) {
    const double t = static_cast<double>(i) / cone_rings;
    profile.push_back({joint.radius + t * (shaft_radius - joint.radius), joint.z + t * cone_height});
  }
  const double shaft_begin = profile.back().z;
  constexpr int shaft_rings = 6;
  for (int i = 1; i <= shaft_rings; ++i) {
    profile.push_back({shaft_radius, shaft_begin + (length - shaft_begin) * i / shaft_rings});
  }
  profile.push_back({shaft_radius / 2, length});
  profile.push_back({0, length});
  return geometry::revolved(profile, segments, "stylus");
}

}  // namespace palpate::synth
