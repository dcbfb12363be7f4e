// SPDX-License-Identifier: MIT
#include "device/recording/replay.hpp"

#include <cmath>

namespace palpate::device {

Replay replay(const RunLog& log, ForceSource& source,
              const std::function<void(const RunTick&, const TickOutput&)>& each) {
  Replay result;
  SafetyController controller(safety_limits(log.header));
  std::uint32_t next = 1;
  for (const RunTick& record : log.records) {
    const TickOutput out = controller.step(to_input(record), source);
    result.missing += record.number - next;
    next = record.number + 1;
    ++result.ticks;
    if (result.missing == 0) {
      ++result.compared;
      if (!same_output(record, out)) {
        if (result.different++ == 0) result.first_different = record.number;
        const Vec3 was{record.force[0], record.force[1], record.force[2]};
        result.largest = std::fmax(result.largest, length(out.command.force - was));
      }
    }
    if (each) each(record, out);
  }
  return result;
}

}  // namespace palpate::device
