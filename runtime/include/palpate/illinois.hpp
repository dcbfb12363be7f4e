// SPDX-License-Identifier: MIT
// A bracketed root by the Illinois rule (Dowell and Jarratt, BIT 11, 1971): regula falsi that halves the value at an
// end which stays, and each fourth time the bracket.
#pragma once

namespace palpate::runtime {

struct Illinois {
  double low, at_low;    ///< where the function is not above 0, and its value there
  double high, at_high;  ///< where it is above 0
  int looks = 0, stayed = 0;

  /// Where to look next.
  [[nodiscard]] double next() const {
    return looks % 4 == 3 ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high);
  }
  /// It is `at` there.
  void narrow(double where, double at) {
    ++looks;
    if (at > 0) {
      high = where;
      at_high = at;
      if (stayed > 0) at_low *= 0.5;
      stayed = 1;
    } else {
      low = where;
      at_low = at;
      if (stayed < 0) at_high *= 0.5;
      stayed = -1;
    }
  }
};

}  // namespace palpate::runtime
