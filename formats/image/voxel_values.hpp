// SPDX-License-Identifier: MIT
// Numbers of voxels as labels: whole numbers of 32 bits, or an error that names the voxel.
#pragma once

#include "formats/io/error.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <sstream>
#include <type_traits>
#include <vector>

namespace palpate::detail {

/// The label of voxel `k`. Throws Error(bad_input) naming file and voxel for a number that is no whole number of 32
/// bits.
template <class Number>
std::int32_t label_of(const std::filesystem::path& file, std::size_t k, Number number) {
  const auto whole = static_cast<std::int32_t>(
      number >= Number(0) ? std::min<long double>(number, std::numeric_limits<std::int32_t>::max())
                          : std::max<long double>(number, std::numeric_limits<std::int32_t>::min()));
  if (static_cast<long double>(whole) == static_cast<long double>(number)) return whole;
  std::ostringstream text;
  text << file.string() << ": voxel " << k << " has the value " << +number
       << "; allowed: whole numbers of 32 bits (a label image, not a scan)";
  throw Error(ExitCode::bad_input, text.str());
}

/// Converts values.size() numbers. Throws as label_of does.
template <class Number>
void to_labels(const std::filesystem::path& file, const void* bytes, std::vector<std::int32_t>& values) {
  // Types whose every value fits need no check.
  constexpr bool fits = std::is_integral_v<Number> && (sizeof(Number) < 4 || std::is_same_v<Number, std::int32_t>);
  for (std::size_t k = 0; k < values.size(); ++k) {
    Number number;
    std::memcpy(&number, static_cast<const unsigned char*>(bytes) + k * sizeof number, sizeof number);
    if constexpr (fits) {
      values[k] = number;
    } else {
      values[k] = label_of(file, k, number);
    }
  }
}

/// Converts numbers of a header's scale: slope * number + intercept, in the header's single precision.
template <class Number>
void to_scaled_labels(const std::filesystem::path& file, const void* bytes, float slope, float intercept,
                      std::vector<std::int32_t>& values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    Number number;
    std::memcpy(&number, static_cast<const unsigned char*>(bytes) + k * sizeof number, sizeof number);
    values[k] = label_of(file, k, slope * static_cast<float>(number) + intercept);
  }
}

}  // namespace palpate::detail
