// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/laws/recorded_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "formats/io/error.hpp"

namespace palpate::fit {
namespace {

constexpr double kKept = 0.5;            // of the samples, by which the curves are found
constexpr double kFarOut = 5.0;          // spreads: an outlier
constexpr double kNear = 0.01;           // of the force: a spread is never taken for smaller
constexpr double kRecordedFloor = 0.02;  // of the peak force, below which that counts as the force
constexpr double kSolvedError = 0.01;    // of the force, that solved samples have
constexpr double kMostOutliers = 0.25;   // of the samples
constexpr double kMostResidual = 0.1;    // rms over the largest force
constexpr double kLeastDepth = 0.5;      // of the required depth
constexpr double kWidestGap = 0.25;      // in sqrt of depth, of the whole
constexpr std::size_t kFewest = 8;       // normal indentations
constexpr std::size_t kFewestAside = 4;  // to each side
constexpr std::size_t kMost = 50000;     // rows
constexpr std::size_t kNeighbours = 15;
constexpr int kRounds = 20;

using Marks = std::vector<bool>;  // per sample: it is fitted

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * share);
  return text;
}

class Trimmed {
public:
  Trimmed(const std::vector<Sample>& samples, const ResponseScales& scales, const std::string& what)
      : samples_(samples), scales_(scales), what_(what), kept_(samples.size(), true), spread_(samples.size(), 0.0) {
    for (const SampleKind kind : {SampleKind::normal, SampleKind::tangential}) {
      std::vector<std::size_t> list;
      for (std::size_t k = 0; k < samples.size(); ++k) {
        if (samples[k].kind == kind) list.push_back(k);
      }
      std::stable_sort(list.begin(), list.end(), [&](std::size_t a, std::size_t b) {
        return samples[a].deflection.z() < samples[b].deflection.z();
      });
      if (!list.empty()) by_depth_.push_back(std::move(list));
    }
  }

  RecordedFit run() {
    fit();
    for (int round = 0; round < kRounds && keep_nearest(); ++round) fit();
    weigh_ = true;
    fit();
    for (int round = 0; round < kRounds && drop_outliers(); ++round) fit();
    RecordedFit result;
    result.response = response_;
    double squares = 0, count = 0;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      if (!kept_[k]) {
        result.outliers.push_back(k);
        continue;
      }
      squares += distance_[k] * distance_[k];
      count += 1;
      result.worst = std::max(result.worst, distance_[k]);
      if (samples_[k].kind == SampleKind::normal) result.depth = std::max(result.depth, samples_[k].deflection.z());
    }
    result.rms = std::sqrt(squares / std::max(count, 1.0));
    return result;
  }

  [[nodiscard]] double peak() const { return peak_; }

private:
  [[nodiscard]] double largest_force() const {
    double most = 0;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      if (kept_[k]) most = std::max(most, samples_[k].force.norm());
    }
    return most;
  }

  /// Fits what is kept, then finds the distances of all samples and how far their like are scattered.
  void fit() {
    std::vector<Sample> kept;
    peak_ = largest_force();
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      if (!kept_[k]) continue;
      Sample& sample = kept.emplace_back(samples_[k]);
      const double size = std::max(sample.force.norm(), kRecordedFloor * peak_);
      if (weigh_) sample.weight *= size / std::hypot(size, spread_[k] / kSolvedError);
    }
    response_ = fit_pair(kept, scales_, what_);
    const Potential potential(response_.coefs, scales_);
    distance_.resize(samples_.size());
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      distance_[k] = (potential.force(samples_[k].deflection) - samples_[k].force).norm();
    }
    for (const auto& list : by_depth_) spread_along(list, potential);
  }

  /// The median distance of the quarter of the samples nearest in depth: most of them are none of the outliers.
  void spread_along(const std::vector<std::size_t>& list, const Potential& potential) {
    const std::size_t n = list.size(), window = std::min(n, std::max(kNeighbours, n / 4));
    std::vector<double> near(window);
    double median = 0;
    std::size_t last = n;  // begin of the window whose median it is
    for (std::size_t i = 0; i < n; ++i) {
      // Many thousands of rows: neighbours share a window.
      const std::size_t step = std::max<std::size_t>(1, window / 8), middle = i / step * step;
      const std::size_t begin = std::min(middle > window / 2 ? middle - window / 2 : 0, n - window);
      if (begin != last) {
        for (std::size_t k = 0; k < window; ++k) near[k] = distance_[list[begin + k]];
        std::nth_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(window / 2), near.end());
        median = near[window / 2];
        last = begin;
      }
      const double force = potential.force(samples_[list[i]].deflection).norm();
      spread_[list[i]] = std::max(median, kNear * std::max(force, kRecordedFloor * peak_));
    }
  }

  /// A concentration step; false when it changes nothing.
  bool keep_nearest() {
    Marks next(samples_.size(), false);
    for (std::vector<std::size_t> list : by_depth_) {
      const auto count = static_cast<std::size_t>(std::ceil(kKept * static_cast<double>(list.size())));
      std::stable_sort(list.begin(), list.end(), [&](std::size_t a, std::size_t b) { return far(a) < far(b); });
      for (std::size_t k = 0; k < count; ++k) next[list[k]] = true;
    }
    return take(std::move(next));
  }

  bool drop_outliers() {
    Marks next(samples_.size());
    for (std::size_t k = 0; k < next.size(); ++k) next[k] = far(k) <= kFarOut;
    return take(std::move(next));
  }

  [[nodiscard]] double far(std::size_t k) const { return distance_[k] / spread_[k]; }

  bool take(Marks next) {
    if (next == kept_) return false;
    kept_ = std::move(next);
    return true;
  }

  const std::vector<Sample>& samples_;
  const ResponseScales& scales_;
  const std::string& what_;
  std::vector<std::vector<std::size_t>> by_depth_;  // normal indentations, tangential ones
  Marks kept_;
  std::vector<double> spread_, distance_;  // N
  bool weigh_ = false;
  double peak_ = 0.0;  // N, of what was fitted last
  PairResponse response_;
};

/// Throws unless the normal indentations are enough for a curve.
void check_pushes(const std::vector<Sample>& samples, const Marks& kept, double depth, const std::string& what) {
  std::vector<double> depths{0.0};
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (kept[k] && samples[k].kind == SampleKind::normal) depths.push_back(samples[k].deflection.z());
  }
  std::sort(depths.begin(), depths.end());
  const auto refuse = [&](const std::string& cause) { throw Error(ExitCode::bad_input, what + ": " + cause); };
  if (depths.size() - 1 < kFewest) {
    refuse("a response needs at least " + std::to_string(kFewest) + " rows of normal indentations; there are " +
           std::to_string(depths.size() - 1));
  }
  char text[160];
  if (depths.back() < kLeastDepth * depth) {
    std::snprintf(text, sizeof text, "its pushes reach %.3g mm, less than half of the %.3g mm that are sampled there",
                  1e3 * depths.back(), 1e3 * depth);
    refuse(text);
  }
  for (std::size_t k = 1; k < depths.size(); ++k) {
    if (std::sqrt(depths[k]) - std::sqrt(depths[k - 1]) <= kWidestGap * std::sqrt(depths.back())) continue;
    std::snprintf(text, sizeof text, "no row between the depths %.3g and %.3g mm; record one there",
                  1e3 * depths[k - 1], 1e3 * depths[k]);
    refuse(text);
  }
}

/// Throws unless enough is pushed to each side: along one axis alone, nothing is known of the other.
void check_sides(const std::vector<Sample>& samples, const Marks& kept, const std::string& what) {
  std::array<std::size_t, 4> sides{};
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (!kept[k] || samples[k].kind != SampleKind::tangential) continue;
    const Eigen::Vector3d& d = samples[k].deflection;
    const int axis = std::abs(d.x()) >= std::abs(d.y()) ? 0 : 1;
    ++sides[static_cast<std::size_t>(2 * axis + (d[axis] < 0 ? 1 : 0))];
  }
  if (*std::min_element(sides.begin(), sides.end()) >= kFewestAside) return;
  char text[256];
  std::snprintf(text, sizeof text,
                ": in a scene with friction a response needs at least %zu rows pushed aside to each of four sides; "
                "there are %zu, %zu, %zu and %zu to the contact's +x, -x, +y and -y",
                kFewestAside, sides[0], sides[1], sides[2], sides[3]);
  throw Error(ExitCode::bad_input, what + text);
}

void check_rows(const std::vector<Sample>& samples, const Marks& kept, double depth, bool friction,
                const std::string& what) {
  check_pushes(samples, kept, depth, what);
  if (friction) check_sides(samples, kept, what);
}

/// Only the ratios of the rows' weights matter: priors and residuals have no weight.
std::vector<Sample> with_mean_weight_of_one(std::vector<Sample> samples) {
  double sum = 0;
  for (const Sample& sample : samples) sum += sample.weight;
  for (Sample& sample : samples) sample.weight *= static_cast<double>(samples.size()) / sum;
  return samples;
}

}  // namespace

void check_recorded(const std::vector<Sample>& samples, double depth, bool friction, const std::string& what) {
  if (samples.size() > kMost) {
    throw Error(ExitCode::bad_input, what + ": it has " + std::to_string(samples.size()) + " rows, allowed " +
                                         std::to_string(kMost) + ": thin it");
  }
  check_rows(samples, Marks(samples.size(), true), depth, friction, what);
}

RecordedFit fit_recorded(const std::vector<Sample>& recorded, double depth, const ResponseScales& scales,
                         const std::string& what) {
  check_recorded(recorded, depth, scales.friction(), what);
  const std::vector<Sample> samples = with_mean_weight_of_one(recorded);
  Trimmed trimmed(samples, scales, what);
  RecordedFit result;
  try {
    result = trimmed.run();
  } catch (const Error& error) {  // whatever no curve can be put through, it is the recording that is wrong
    throw Error(ExitCode::bad_input, error.what());
  }
  const double outliers = static_cast<double>(result.outliers.size()) / static_cast<double>(samples.size());
  if (outliers > kMostOutliers) {
    throw Error(ExitCode::bad_input, what + ": " + percent(outliers) + " of its rows lie off the fit of the others");
  }
  Marks kept(samples.size(), true);
  for (const std::size_t k : result.outliers) kept[k] = false;
  check_rows(samples, kept, depth, scales.friction(), what);
  const double peak = trimmed.peak();
  if (!(result.rms <= kMostResidual * peak)) {
    throw Error(ExitCode::bad_input, what + ": its rows lie " + percent(result.rms / peak) +
                                         " of the largest force off any fit, allowed " + percent(kMostResidual) +
                                         " (forces on the tool, in the body's frame?)");
  }
  return result;
}

}  // namespace palpate::fit
