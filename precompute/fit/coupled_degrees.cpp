// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/coupled_degrees.hpp"

#include <algorithm>
#include <cmath>

#include "formats/error.hpp"
#include "precompute/fit/pair_samples.hpp"

namespace palpate::fit {
namespace {

constexpr std::size_t kMostPairs = 24;
constexpr int kLeaveEvery = 5;
constexpr double kRounding = 0.1;  // of the tolerance, that the coefficients' rounding may take

std::vector<coupled::Degrees> candidates(bool lateral, int order) {
  std::vector<coupled::Degrees> all;
  if (!lateral) all = {coupled::kSpring, {2, 3, 0, 2, 0, 0, 2}};
  for (int stiffness = 2; stiffness <= 4; ++stiffness) {
    for (const int more : {2, 3}) {
      for (const bool straight : {false, true}) {
        // A force of its own that is too small to be left in for its own sake may still serve the whole.
        if (stiffness + more > coupled::kMaxDegree || (lateral && !straight)) continue;
        coupled::Degrees d{2, stiffness + more, straight ? stiffness + 1 : 0, stiffness, 0, 0, 3};
        for (; d.order <= 4; ++d.order) all.push_back(d);
      }
    }
  }
  std::erase_if(all, [&](const coupled::Degrees& d) { return order != 0 && d.order != order; });
  std::stable_sort(all.begin(), all.end(), [](const coupled::Degrees& a, const coupled::Degrees& b) {
    return coupled::count(a) < coupled::count(b);
  });
  return all;
}

// Nearest rank.
HeldOutFigures figures(std::vector<double> errors) {
  HeldOutFigures f;
  f.samples = errors.size();
  if (errors.empty()) return f;
  std::sort(errors.begin(), errors.end());
  const std::size_t n = errors.size();
  f.median = errors[(n - 1) / 2];
  f.p95 = errors[(95 * n + 99) / 100 - 1];
  f.worst = errors.back();
  return f;
}

}  // namespace

SampleSplit split_samples(const std::vector<Sample>& samples) {
  SampleSplit split;
  std::uint16_t first = 0xFFFF, last = 0;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal) continue;
    first = std::min(first, s.index);
    last = std::max(last, s.index);
  }
  for (const Sample& s : samples) {
    // Offset by the kind and a step prime to directions and points: no direction and no depth is left out as a whole.
    const bool inner =
        s.kind == SampleKind::tangential || (s.kind == SampleKind::normal && s.index > first && s.index < last);
    (inner && (s.index + (s.kind == SampleKind::normal ? 2 : 1)) % kLeaveEvery == 0 ? split.left_out : split.kept)
        .push_back(s);
  }
  return split;
}

HeldOutFigures held_out_figures(const std::vector<const std::vector<Sample>*>& pairs, const LawFitter& fit) {
  std::vector<double> errors;
  for (const auto* samples : pairs) {
    const SampleSplit split = split_samples(*samples);
    ForceLaw law;
    try {
      law = fit(split.kept);
    } catch (const Error&) {  // covered from its neighbours in the fit
      continue;
    }
    const PairSamples data = sort_samples(*samples, "held out");
    for (const Sample& s : split.left_out) errors.push_back((law(s.deflection) - s.force).norm() * data.weight(s));
  }
  return figures(std::move(errors));
}

HeldOutFigures held_out_figures(const std::vector<const std::vector<Sample>*>& pairs, const ModelScales& model) {
  return held_out_figures(pairs, [&](const std::vector<Sample>& samples) -> ForceLaw {
    return [curves = fit_pair(samples, model, "held out"), &model](const Eigen::Vector3d& deflection) {
      return evaluate(curves, model, deflection);
    };
  });
}

DegreeChoice choose_degrees(const std::vector<const std::vector<Sample>*>& pairs, ModelScales scales, bool lateral,
                            const DegreeWish& wish) {
  std::vector<const std::vector<Sample>*> drawn;
  const std::size_t count = std::min(kMostPairs, pairs.size());
  for (std::size_t k = 0; k < count; ++k) drawn.push_back(pairs[k * pairs.size() / count]);
  DegreeChoice best;
  best.held_out.p95 = HUGE_VAL;
  for (const coupled::Degrees& degrees :
       wish.spring ? std::vector{coupled::kSpring} : candidates(lateral, wish.order)) {
    scales.coupled = degrees;
    const HeldOutFigures f = held_out_figures(drawn, scales);
    if (f.samples == 0 || !(f.p95 < best.held_out.p95)) continue;
    best = {degrees, 16, f, f.p95 <= wish.tolerance};
    if (best.met) break;
  }
  scales.coupled = best.degrees;
  for (scales.bits = 8; !wish.spring && scales.bits < 16; scales.bits += 4) {
    const HeldOutFigures f = held_out_figures(drawn, scales);
    const double most =
        std::max(best.held_out.p95, std::min(wish.tolerance, best.held_out.p95 + kRounding * wish.tolerance));
    if (!(f.samples == best.held_out.samples && f.p95 <= most)) continue;
    best.bits = scales.bits;
    best.held_out = f;
    break;
  }
  if (best.held_out.samples == 0) {
    throw Error(ExitCode::numerical, "coupled model: no pair has samples that it could be fitted to and tested on");
  }
  return best;
}

}  // namespace palpate::fit
