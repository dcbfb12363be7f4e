// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/error_time.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace palpate::verify {
namespace {

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] / b[k] - 1) * (a[k] / b[k] - 1);
  return std::sqrt(sum / double(a.size()));
}

// Errors and times of the timed sizes, the smallest error first.
std::vector<std::pair<double, double>> timed(const ErrorTime& curve) {
  std::vector<std::pair<double, double>> points;
  for (std::size_t k = 0; k < curve.errors.size(); ++k) {
    if (curve.seconds[k] > 0) points.emplace_back(curve.errors[k], curve.seconds[k]);
  }
  std::sort(points.begin(), points.end());
  return points;
}

// `error` lies between the first and the last.
double seconds_at(const std::vector<std::pair<double, double>>& points, double error) {
  std::size_t k = 0;
  while (k + 2 < points.size() && points[k + 1].first < error) ++k;
  const auto& [e0, t0] = points[k];
  const auto& [e1, t1] = points[k + 1];
  return e0 == e1 ? t0 : t0 * std::pow(t1 / t0, std::log(error / e0) / std::log(e1 / e0));
}

}  // namespace

ErrorTime error_against_time(const SizeStudy& study) {
  const auto& h = study.sizes;
  const auto& f = study.values;
  bool fit = h.size() >= 3 && f.size() == h.size() && study.seconds.size() == h.size() && h[0] > h[1];
  for (std::size_t k = 1; fit && k + 1 < h.size(); ++k) fit = std::abs(h[k - 1] * h[k + 1] / (h[k] * h[k]) - 1) < 0.01;
  if (!fit) throw std::invalid_argument("three mesh sizes or more in a constant ratio are wanted");
  const std::size_t last = h.size() - 1;
  ErrorTime result;
  result.seconds = study.seconds;
  const double ratio = h[0] / h[1];
  result.order = std::log(distance(f[last - 2], f[last - 1]) / distance(f[last - 1], f[last])) / std::log(ratio);
  result.observed = result.order >= 1 && result.order <= 4;
  if (!result.observed) result.order = 2;
  const double gain = std::pow(ratio, result.order) - 1;
  for (std::size_t k = 0; k < f[last].size(); ++k) {
    result.limit.push_back(f[last][k] + (f[last][k] - f[last - 1][k]) / gain);
  }
  for (const auto& values : f) result.errors.push_back(distance(values, result.limit));
  return result;
}

std::vector<TimeRatio> time_ratios(const ErrorTime& ours, const ErrorTime& other) {
  const auto a = timed(ours), b = timed(other);
  if (a.size() < 2 || b.size() < 2) return {};
  const double low = std::max(a.front().first, b.front().first), high = std::min(a.back().first, b.back().first);
  std::vector<TimeRatio> ratios;
  if (!(low > 0 && low <= high)) return ratios;
  for (const double error : {low, std::sqrt(low * high), high}) {
    ratios.push_back({error, seconds_at(a, error), seconds_at(b, error)});
  }
  return ratios;
}

}  // namespace palpate::verify
