// SPDX-License-Identifier: GPL-3.0-or-later
// Compares statistics with limits.
#include "precompute/verify/held_out/limits.hpp"

#include <cstdio>

namespace palpate::verify {
namespace {

constexpr double kRefusedShare = 0.1;

std::string percentile_over(const ErrorStatistics& s, const std::optional<double>& limit, const char* push) {
  char text[160] = "";
  if (limit && s.count == 0) {
    std::snprintf(text, sizeof text, "no %s force was solved, required a 95th percentile of %.4g", push, *limit);
  } else if (limit && !(s.p95 <= *limit)) {
    std::snprintf(text, sizeof text, "95th percentile of the %s force error is %.4g, required %.4g", push, s.p95,
                  *limit);
  }
  return text;
}

}  // namespace

std::optional<std::string> broken_limits(const VerifyStatistics& s, const VerifyLimits& limits) {
  if (!limits.p95 && !limits.p95_tangential && !limits.p95_spins && !limits.refused_share) return std::nullopt;
  std::string all;
  const auto add = [&](const std::string& text) {
    if (!text.empty()) all += (all.empty() ? "" : "; ") + text;
  };
  add(percentile_over(s.normal, limits.p95, "normal"));
  add(percentile_over(s.tangential, limits.p95_tangential, "tangential"));
  add(percentile_over(s.spins, limits.p95_spins, "held-out spins'"));
  const double most = limits.refused_share.value_or(kRefusedShare);
  if (static_cast<double>(s.refused) > most * static_cast<double>(s.contacts)) {
    char text[160];
    std::snprintf(text, sizeof text, "%zu of %zu held-out contacts were refused, required a share of at most %.4g",
                  s.refused, s.contacts, most);
    add(text);
  }
  if (all.empty()) return std::nullopt;
  return all;
}

}  // namespace palpate::verify
