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
  const double places = 4 - std::floor(std::log10(std::abs(value))), scale = std::pow(10.0, std::abs(places));
  // A whole number as scale keeps both ways exact.
  return places >= 0 ? std::round(value * scale) / scale : std::round(value / scale) * scale;
}

}  // namespace palpate::report
