// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/laws/potential_degrees.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/io/error.hpp"
#include "precompute/fit/laws/pair_samples.hpp"

namespace palpate::fit {
namespace {

using Pairs = std::vector<const std::vector<Sample>*>;

constexpr std::size_t kMostPairs = 24, kMostPushes = 240;
constexpr int kLeaveEvery = 5;
constexpr double kRounding = 0.1;  // share of the tolerance that rounding the coefficients may take

std::vector<response::Degrees> candidates(bool bias, bool friction) {
  std::vector<response::Degrees> all;
  // A bias below the threshold may still serve the whole, so candidates with a bias are always tried.
  for (int normal = 2; !friction && normal <= response::kMaxDegree; ++normal) {
    if (!bias) all.push_back({normal, 0, 0, 0, false});
    all.push_back({normal, std::max(2, normal - 1), 0, 0, false});
  }
  if (friction && !bias) all = {response::kSpring, {3, 0, 2, 2, true}};
  for (int stiffness = 2; friction && stiffness <= 4; ++stiffness) {
    for (const int more : {2, 3}) {
      if (stiffness + more > response::kMaxDegree) continue;
      if (!bias) all.push_back({stiffness + more, 0, stiffness, 3, true});
      all.push_back({stiffness + more, stiffness + 1, stiffness, 3, true});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const response::Degrees& a, const response::Degrees& b) {
    return response::count(a) < response::count(b);
  });
  return all;
}

// Degrees of a scene with too few samples to leave any out. Throws when no pair can be fitted.
DegreeChoice usual_degrees(const Pairs& pairs, ResponseScales scales, bool bias) {
  scales.degrees = scales.friction() ? response::Degrees{5, bias ? 4 : 0, 3, 3, true}
                                     : response::Degrees{4, bias ? 3 : 0, 0, 0, false};
  std::string cause = "there is none";
  for (const auto* samples : pairs) {
    try {
      fit_pair(*samples, scales, "degrees");
      return {scales.degrees, 16, {}, false};
    } catch (const Error& error) {
      cause = error.what();
    }
  }
  throw Error(ExitCode::numerical, "responses: no accepted pair can be fitted: " + cause);
}

// Nearest rank.
SampleFigures figures(std::vector<double> errors) {
  SampleFigures f;
  f.samples = errors.size();
  if (errors.empty()) return f;
  std::sort(errors.begin(), errors.end());
  const std::size_t n = errors.size();
  f.median = errors[(n - 1) / 2];
  f.p95 = errors[(95 * n + 99) / 100 - 1];
  f.worst = errors.back();
  return f;
}

Pairs drawn(const Pairs& pairs, std::size_t most) {
  Pairs result;
  const std::size_t count = std::min(most, pairs.size());
  for (std::size_t k = 0; k < count; ++k) result.push_back(pairs[k * pairs.size() / count]);
  return result;
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
    // The offset and a step prime to directions and points leave out no direction and no depth as a whole.
    const bool inner =
        s.kind == SampleKind::tangential || (s.kind == SampleKind::normal && s.index > first && s.index < last);
    (inner && (s.index + (s.kind == SampleKind::normal ? 2 : 1)) % kLeaveEvery == 0 ? split.left_out : split.kept)
        .push_back(s);
  }
  return split;
}

PartFigures part_figures(const Pairs& pairs, const LawFitter& fit) {
  std::vector<double> fitted, left_out;
  for (const auto* samples : pairs) {
    const SampleSplit split = split_samples(*samples);
    ForceLaw law;
    try {
      law = fit(split.kept);
    } catch (const Error&) {  // filled from its neighbours in the fit
      continue;
    }
    const PairSamples data = sort_samples(*samples, "held out");
    const auto error = [&](const Sample& s) { return (law(s.deflection) - s.force).norm() * data.weight(s); };
    for (const Sample& s : split.kept) {
      if (s.kind == SampleKind::normal || s.kind == SampleKind::tangential) fitted.push_back(error(s));
    }
    for (const Sample& s : split.left_out) left_out.push_back(error(s));
  }
  return {figures(std::move(fitted)), figures(std::move(left_out))};
}

PartFigures part_figures(const Pairs& pairs, const ResponseScales& scales) {
  return part_figures(pairs, [&](const std::vector<Sample>& samples) -> ForceLaw {
    return [law = Potential(fit_pair(samples, scales, "held out").coefs, scales)](const Eigen::Vector3d& deflection) {
      return law.force(deflection);
    };
  });
}

DegreeChoice choose_degrees(const Pairs& pairs, const Pairs& pushes, ResponseScales scales, bool bias,
                            double tolerance) {
  const Pairs some = drawn(pairs, kMostPairs), some_pushes = drawn(pushes, kMostPushes);
  struct Errors {
    SampleFigures left_out;
    std::array<double, 4> p95{};  // of both parts, of whole pairs and of normal indentations
    [[nodiscard]] double most() const { return *std::max_element(p95.begin(), p95.end()); }
  };
  const auto errors = [&] {
    const PartFigures full = part_figures(some, scales);
    ResponseScales normal = scales;
    normal.tangential = 0;
    normal.degrees = {scales.degrees.normal, scales.degrees.bias, 0, 0, false};
    const PartFigures alone = part_figures(some_pushes, normal);
    Errors e;
    if (full.left_out.samples == 0) return e;
    e.left_out = alone.left_out.p95 > full.left_out.p95 ? alone.left_out : full.left_out;
    e.left_out.samples = full.left_out.samples + alone.left_out.samples;
    e.p95 = {full.left_out.p95, full.fitted.p95, alone.left_out.p95, alone.fitted.p95};
    return e;
  };
  DegreeChoice best;
  Errors least;
  least.p95.fill(HUGE_VAL);
  for (const response::Degrees& degrees : candidates(bias, scales.friction())) {
    scales.degrees = degrees;
    const Errors e = errors();
    if (e.left_out.samples == 0 || !(e.most() < least.most())) continue;
    least = e;
    best = {degrees, 16, e.left_out, e.most() <= tolerance};
    if (best.met) break;
  }
  if (best.held_out.samples == 0) return usual_degrees(some, scales, bias);
  scales.degrees = best.degrees;
  for (scales.bits = 8; scales.bits < 16; scales.bits += 4) {
    const Errors e = errors();
    bool little = e.left_out.samples == best.held_out.samples;
    for (std::size_t k = 0; k < e.p95.size(); ++k) {
      const double most = std::max(least.p95[k], std::min(tolerance, least.p95[k] + kRounding * tolerance));
      little = little && e.p95[k] <= most;
    }
    if (!little) continue;
    best.bits = scales.bits;
    best.held_out = e.left_out;
    break;
  }
  return best;
}

}  // namespace palpate::fit
