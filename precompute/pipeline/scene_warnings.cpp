// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/pipeline/scene_warnings.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace palpate::pipeline {
namespace {

constexpr double kSlender = 2.5;  // farthest point over the width of what is held

template <class... Values>
std::string line(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/// How far the body reaches away from what holds it, over how wide that is; 0 where nothing or all of it is held.
double slenderness(const Body& body) {
  Eigen::AlignedBox3d foot;
  for (const Eigen::Vector3d& v : body.base.vertices) {
    if (body.held(body.query->closest(v).point)) foot.extend(v);
  }
  if (foot.isEmpty()) return 0;
  double far = 0;
  for (const Eigen::Vector3d& v : body.base.vertices) far = std::max(far, foot.exteriorDistance(v));
  Eigen::Vector3d sizes = foot.sizes();
  std::sort(sizes.data(), sizes.data() + 3);
  return far / std::max(sizes[1], 1e-9);  // the middle one: a foot is flat
}

}  // namespace

std::vector<std::string> scene_warnings(const Scene& scene, const Body& body) {
  std::vector<std::string> warnings;
  const double wall = body.report.thickness_median, most = scene.sampling.depth_fraction * wall;
  if (wall > 0 && scene.sampling.depth > most) {
    warnings.push_back(line(
        "sampling.depth is %.3g mm, more than %g of the median thickness of %.3g mm: most pushes end at %.3g mm or "
        "less; set sampling.depth to what the tool will do",
        1e3 * scene.sampling.depth, scene.sampling.depth_fraction, 1e3 * wall, 1e3 * most));
  }
  if (const double slender = slenderness(body); slender > kSlender) {
    warnings.push_back(
        line("the body reaches %.1f times as far from what holds it as that is wide, and will bend as a "
             "beam where it is pushed%s",
             slender,
             scene.supports.empty() ? "; no [[support]] is given, so its lowest tenth along z is held: give the "
                                      "supports that hold it (half_space, box, mesh, distance, a spring bed)"
                                    : "; is [[support]] as meant?"));
  }
  return warnings;
}

}  // namespace palpate::pipeline
