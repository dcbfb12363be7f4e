// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as a report prints them.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace palpate::report {

using Json = nlohmann::ordered_json;

/// `value` rounded to five significant digits, which halves a report; NaN and infinity become null.
inline Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0) return 0;
  const double unit = std::pow(10.0, 4 - std::floor(std::log10(std::abs(value))));
  // Both ways of scaling are exact only where the scale is a whole number.
  return unit >= 1 ? std::round(value * unit) / unit : std::round(value / (1 / unit)) * (1 / unit);
}

}  // namespace palpate::report
