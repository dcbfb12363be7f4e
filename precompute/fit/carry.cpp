// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/carry.hpp"

#include <algorithm>
#include <cmath>

#include "formats/io/error.hpp"
#include "precompute/fit/closed_form.hpp"

namespace palpate::fit {
namespace {

constexpr std::size_t kSources = 6;
constexpr double kSameSide = 0.2;  // cosine of the angle between normals

/// The source's response as a law in the frame and to the depth of another site.
class CarriedLaw {
public:
  CarriedLaw(const ContactFrame& frame, double depth, const NormalCurve& own, const CarrySource& source,
             const ResponseScales& scales)
      : law_(blend_sites(frame, depth, {{source.frame, source.full, 1.0}}, scales).response.coefs, scales),
        own_(own),
        normal_(*source.normal),
        stretch_(source.full->depth / depth) {}

  /// Force beside that of the normal indentation.
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& deflection) const {
    const Eigen::Vector3d there = stretch_ * deflection;
    const double ratio = own_.force(deflection.z()).z() / normal_.force(there.z()).z();
    return ratio * (law_.force(there) - law_.force({0, 0, there.z()}));
  }
  [[nodiscard]] double friction(double depth) const { return law_.friction(stretch_ * depth); }

private:
  Potential law_;  // in the site's frame
  const NormalCurve& own_;
  const NormalCurve& normal_;
  double stretch_;
};

}  // namespace

NormalCurve::NormalCurve(const std::vector<Sample>& samples) {
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal && s.deflection.z() > 0 && s.force.z() > 0) {
      points_.emplace_back(s.deflection.z(), s.force);
    }
  }
  std::sort(points_.begin(), points_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (points_.size() < 2) {
    throw Error(ExitCode::numerical,
                "a normal indentation needs two depths with a force; there are " + std::to_string(points_.size()));
  }
}

Eigen::Vector3d NormalCurve::force(double depth) const {
  auto to = std::lower_bound(points_.begin(), points_.end(), depth,
                             [](const auto& point, double z) { return point.first < z; });
  if (to == points_.begin()) {  // Hertz: the force over the depth goes with its root
    return to->second * std::pow(depth / to->first, 1.5);
  }
  if (to == points_.end()) --to;
  const auto from = to - 1;
  const double a = std::sqrt(from->first), b = std::sqrt(to->first), t = (std::sqrt(depth) - a) / (b - a);
  return depth * ((1 - t) / from->first * from->second + t / to->first * to->second);
}

std::vector<Sample> carried_samples(const ContactFrame& frame, double depth, const NormalCurve& own,
                                    const solve::PairPath& path, const std::vector<CarrySource>& sources,
                                    const ResponseScales& scales) {
  double total = 0;
  std::vector<std::pair<double, CarriedLaw>> laws;
  for (const CarrySource& source : sources) {
    laws.emplace_back(source.weight, CarriedLaw(frame, depth, own, source, scales));
    total += source.weight;
  }
  std::vector<Sample> samples = sample_along(path, [&](const Eigen::Vector3d& deflection) {
    Eigen::Vector3d force = own.force(deflection.z());
    for (const auto& [weight, law] : laws) force += weight / total * law.force(deflection);
    return force;
  });
  for (Sample& s : samples) {
    s.friction_limit = 0;
    for (const auto& [weight, law] : laws) s.friction_limit += weight / total * law.friction(s.deflection.z());
  }
  return samples;
}

std::vector<CarrySource> near_sources(const ContactFrame& frame, const std::vector<CarrySource>& all,
                                      const CarrySource* skip) {
  std::vector<CarrySource> near, any;
  for (const CarrySource& source : all) {
    if (&source == skip) continue;
    CarrySource weighted = source;
    weighted.weight = 1.0 / std::max((source.frame->origin - frame.origin).squaredNorm(), 1e-18);
    any.push_back(weighted);
    if (source.frame->n.dot(frame.n) > kSameSide) near.push_back(weighted);
  }
  const auto nearer = [](const CarrySource& a, const CarrySource& b) { return a.weight > b.weight; };
  std::vector<CarrySource>& chosen = near.empty() ? any : near;
  std::stable_sort(chosen.begin(), chosen.end(), nearer);
  chosen.resize(std::min(near.empty() ? std::size_t{1} : kSources, chosen.size()));
  return chosen;
}

}  // namespace palpate::fit
