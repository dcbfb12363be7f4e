// SPDX-License-Identifier: MIT
// Limits of a glove's cables.
#pragma once

#include <cmath>

namespace palpate::device {

struct GloveOptions {
  double limit = 5;       ///< N, (0, 100]: most that a cable pulls
  double rate = 100;      ///< N/s, above 0: most by which a pull changes, as cables that slacken and tighten are felt
  double frequency = 30;  ///< Hz, above 0: of the low-pass
  /// Usable at all.
  [[nodiscard]] bool valid() const {
    return limit > 0 && limit <= 100 && rate > 0 && std::isfinite(rate) && frequency > 0 && std::isfinite(frequency);
  }
};

}  // namespace palpate::device
