// SPDX-License-Identifier: GPL-3.0-or-later
// A run of a device in the terminal: where it stands, live, and the keys that stop it.
#pragma once

#include <string>

#include "device/loop/loop.hpp"

namespace palpate::cli {

/// Keys as they are pressed, while it lives and standard input is a terminal that this program may read. One at a time.
class Keys {
public:
  Keys();
  ~Keys();  ///< the terminal as it was
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  /// The next key, or 0 after `milliseconds` without one.
  int wait(int milliseconds) const;

  /// The terminal as it was, where one lives; async-signal-safe, for a program that ends without its destructor.
  static void restore_terminal();

private:
  bool terminal_ = false;
};

/// Values that are constant during a run.
struct DriveTitle {
  std::string file, tool, device;
  double limit = 0;    ///< N
  bool glove = false;  ///< five pulls instead of a force
};

/// Mode, and the cause where there is no force: "engaged", "suspended: the sample is stale".
std::string standing(const device::TickOutput& out);

/// Several lines, each ended, without colours or cursor movements.
std::string drive_screen(const DriveTitle& title, const device::LoopReport& report, std::uint64_t dropped);

/// The same in one line.
std::string drive_line(const DriveTitle& title, const device::LoopReport& report);

/// Statistics at the end or on request: several lines.
std::string drive_statistics(const device::LoopReport& report, std::uint64_t dropped);

/// Draws on standard error: over its last screen on a terminal, a line a second elsewhere.
class DriveView {
public:
  explicit DriveView(const DriveTitle& title);
  void show(const device::LoopReport& report, std::uint64_t dropped);
  /// Leaves the last screen as it is: what is printed next comes below.
  void rest() { lines_ = 0; }

private:
  DriveTitle title_;
  bool terminal_;
  int lines_ = 0;    // of the last screen
  double next_ = 0;  // s of the run, when to print the next line
};

}  // namespace palpate::cli
