// SPDX-License-Identifier: GPL-3.0-or-later
// Shows a bake's progress: one line rewritten in place on a terminal, a plain line now and then elsewhere.
#pragma once

#include <cstdio>
#include <string>

#include "precompute/bake/bake.hpp"

namespace palpate::bake {

/// "bake 120/600 pairs (20.0 %), 1 refused, 4100 pairs/h, 7 min 1 s left".
std::string progress_text(const BakeProgress& progress);

/// "59 s", "7 min 1 s", "2 h 5 min".
std::string duration_text(double seconds);

class ProgressPrinter {
public:
  /// `stream` must outlive the printer. Elsewhere than on a terminal it prints at most every `quiet_interval` s.
  explicit ProgressPrinter(std::FILE* stream, double quiet_interval = 10.0);
  void operator()(const BakeProgress& progress);
  /// Ends the line on a terminal.
  void finish();

private:
  std::FILE* stream_;
  double quiet_interval_;
  bool terminal_;
  double printed_ = -1.0;
  std::size_t width_ = 0;
};

}  // namespace palpate::bake
