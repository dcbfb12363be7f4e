// SPDX-License-Identifier: MIT
// How often which length of time: of periods, ages and deadlines, kept while a loop runs.
#pragma once

#include <cmath>
#include <cstdint>

namespace palpate::device {

/// 32 bins an octave from a microsecond on, the last one open: a quantile is right to 2.2 %. Fixed size, copied as it
/// is.
class Histogram {
public:
  /// `seconds` that are negative count as 0, those that are not finite are left out.
  void add(double seconds) {
    if (!std::isfinite(seconds)) return;
    const double t = seconds > 0 ? seconds : 0;
    if (count_ == 0 || t < least_) least_ = t;
    if (t > most_) most_ = t;
    sum_ += t;
    ++count_;
    ++bins_[bin_of(t)];
  }

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] double least() const { return least_; }  ///< s; 0 when empty
  [[nodiscard]] double most() const { return most_; }    ///< s
  [[nodiscard]] double mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0; }  ///< s

  /// s that the share (0 to 1) of all lengths does not exceed: the upper edge of its bin, within the least and the
  /// most.
  [[nodiscard]] double quantile(double share) const {
    const double wanted = share * static_cast<double>(count_);
    std::uint64_t below = 0;
    for (int k = 0; k < kBins; ++k) {
      below += bins_[k];
      if (bins_[k] > 0 && static_cast<double>(below) >= wanted) return std::fmax(least_, std::fmin(most_, edge(k)));
    }
    return most_;
  }

private:
  static constexpr int kBins = 672, kOctave = 32;  // to 2 s
  static constexpr double kFirst = 1e-6;

  static double edge(int bin) { return kFirst * std::exp2(bin / static_cast<double>(kOctave)); }
  static int bin_of(double t) {
    if (!(t > kFirst)) return 0;
    const double bin = std::ceil(kOctave * std::log2(t / kFirst));
    return bin < kBins - 1 ? static_cast<int>(bin) : kBins - 1;
  }

  std::uint32_t bins_[kBins] = {};
  std::uint64_t count_ = 0;
  double least_ = 0, most_ = 0, sum_ = 0;
};

}  // namespace palpate::device
