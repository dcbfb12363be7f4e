// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/laws/path_errors.hpp"

#include <algorithm>

#include "precompute/solve/pair/pair.hpp"

namespace palpate::fit {

std::vector<double> path_errors(const std::vector<Sample>& samples, const PairSamples& data, const ForceAt& force,
                                const DeepenRule& deepen) {
  constexpr int kSteps = 32;  // of the way between two samples
  std::vector<double> errors;
  std::vector<const Sample*> points;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::path) points.push_back(&s);
  }
  std::sort(points.begin(), points.end(), [](const Sample* a, const Sample* b) { return a->index < b->index; });
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();
  Eigen::Vector2d held = Eigen::Vector2d::Zero();
  for (const Sample* s : points) {
    if (s->index % solve::kPathStride == 0) {  // a normal indentation, from where the path leads away
      tool = s->deflection;
      held.setZero();
      continue;
    }
    const Eigen::Vector3d step = (s->deflection - tool) / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      held += step.head<2>();
      if (step.z() > 0) held = deepen(tool.z(), tool.z() + step.z(), held);
      tool += step;
    }
    errors.push_back((force(held, tool.z()) - s->force).norm() * data.weight(*s));
  }
  return errors;
}

}  // namespace palpate::fit
