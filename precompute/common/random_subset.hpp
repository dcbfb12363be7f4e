// SPDX-License-Identifier: GPL-3.0-or-later
// A seeded random subset, the same with every standard library.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

namespace palpate {

/// A share [0, 1] of the numbers 0 to count - 1, at least one where there are any and the share is not 0, in the order
/// drawn.
inline std::vector<std::size_t> random_subset(std::size_t count, double share, std::uint64_t seed) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  std::mt19937_64 engine(seed);
  for (std::size_t k = count; k > 1; --k) std::swap(numbers[k - 1], numbers[engine() % k]);
  numbers.resize(std::min(count, static_cast<std::size_t>(std::ceil(share * static_cast<double>(count)))));
  return numbers;
}

}  // namespace palpate
