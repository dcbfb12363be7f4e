// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/closed_form.hpp"

#include <cmath>
#include <numbers>

namespace palpate::fit {
namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

double ClosedForm::push(double d) const {
  const double plane_strain = young / (1 - poisson * poisson);
  switch (law) {
    case AnalyticScene::Law::hertz:
      return 4.0 / 3.0 * plane_strain * std::sqrt(radius * d) * d;
    case AnalyticScene::Law::punch:
      return 2 * plane_strain * radius * d;
    case AnalyticScene::Law::cone:
      return 2 / kPi * plane_strain * slope * d * d;
    case AnalyticScene::Law::layer: {
      const double x = std::sqrt(radius * d) / thickness;
      return 16.0 / 9.0 * young * std::sqrt(radius * d) * d *
             (1 + x * (1.133 + x * (1.283 + x * (0.769 + x * 0.0975))));
    }
    case AnalyticScene::Law::winkler:
      return stiffness * kPi * radius * d * (flat ? radius : d);
    case AnalyticScene::Law::spring:
      return stiffness * d;
  }
  return 0.0;
}

double ClosedForm::tangential_stiffness(double d) const {
  const double shear = young / (2 * (1 + poisson)), per_radius = 8 * shear / (2 - poisson);
  switch (law) {
    case AnalyticScene::Law::hertz:
      return per_radius * std::sqrt(radius * d);
    case AnalyticScene::Law::punch:
      return per_radius * radius;
    case AnalyticScene::Law::cone:
      return per_radius * 2 / kPi * slope * d;
    case AnalyticScene::Law::winkler:
      return tangential * kPi * radius * (flat ? radius : 2 * d);
    case AnalyticScene::Law::spring:
      return tangential;
    case AnalyticScene::Law::layer:
      break;
  }
  return 0.0;
}

std::vector<Sample> sample_along(const solve::PairPath& path,
                                 const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& force) {
  std::vector<Sample> samples;
  const auto add = [&](SampleKind kind, double x, double y, double depth) {
    Sample sample;
    sample.kind = kind;
    sample.index = static_cast<std::uint16_t>(samples.size());
    sample.deflection = {x, y, depth};
    sample.force = force(sample.deflection);
    sample.friction_limit = path.friction;
    samples.push_back(sample);
  };
  for (const double depth : path.normal_depths) add(SampleKind::normal, 0, 0, depth);
  for (const double depth : path.tangential_depths) {
    for (int direction = 0; direction < path.tangential_directions; ++direction) {
      const double angle = path.tangential_start + 2 * kPi * direction / path.tangential_directions;
      for (int k = 1; k <= path.tangential_points; ++k) {
        const double way = path.tangential_reach * depth * k / path.tangential_points;
        add(SampleKind::tangential, way * std::cos(angle), way * std::sin(angle), depth);
      }
    }
  }
  return samples;
}

std::vector<Sample> sample_law(const ClosedForm& law, const solve::PairPath& path) {
  return sample_along(path, [&](const Eigen::Vector3d& d) -> Eigen::Vector3d {
    const double stiffness = law.tangential_stiffness(d.z());
    return {-stiffness * d.x(), -stiffness * d.y(), law.push(d.z())};
  });
}

}  // namespace palpate::fit
