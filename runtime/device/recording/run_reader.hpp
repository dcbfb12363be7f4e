// SPDX-License-Identifier: MIT
// Reads the recording of a run, strictly: a wrong byte is an error, a run that was cut short is said to be.
#pragma once

#include "device/recording/run_hand.hpp"
#include "device/recording/run_record.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate::device {

struct RunLog {
  bool ok = false;
  std::string error;  ///< what is wrong and where, without the file's name; empty when ok
  RunHeader header;
  std::optional<RunHand> hand;   ///< of a glove's run
  std::vector<RunTick> records;  ///< by ascending number; a gap is of ticks that were dropped
  bool complete = false;         ///< it has its end: neither killed nor refused by the disk
  RunEnd end;                    ///< where it is complete
  std::size_t torn = 0;          ///< bytes at the end that are no whole record: what a kill or a full disk leaves
};

/// Whether these bytes begin as a recording does.
bool is_run_log(const void* data, std::size_t size);

RunLog read_run_log(const void* data, std::size_t size);

}  // namespace palpate::device
