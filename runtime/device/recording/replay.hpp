// SPDX-License-Identifier: MIT
// A recorded run once more: the same inputs through the same rules, and whether the same forces come out.
#pragma once

#include "device/loop/force_source.hpp"
#include "device/recording/run_reader.hpp"

#include <functional>

namespace palpate::device {

struct Replay {
  std::size_t ticks = 0;              ///< replayed
  std::size_t compared = 0;           ///< of these before the first gap: behind it a contact may have another past
  std::size_t different = 0;          ///< of these not the same bit for bit
  std::uint32_t first_different = 0;  ///< the number of the first such tick; 0: none
  double largest = 0;                 ///< N, between the recorded command and the replayed one, of those compared
  std::size_t missing = 0;            ///< ticks that the recording lacks in between
};

/// `source` must be as new. `each` is called for every tick with what came of it now.
Replay replay(const RunLog& log, ForceSource& source,
              const std::function<void(const RunTick&, const TickOutput&)>& each = {});

}  // namespace palpate::device
