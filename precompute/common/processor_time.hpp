// SPDX-License-Identifier: GPL-3.0-or-later
// Processor time of a thread, and an end to it. Time of the clock would make results depend on the machine's load.
#pragma once

#include "formats/io/error.hpp"

#include <ctime>
#include <limits>

namespace palpate {

/// Processor time of this thread (s).
inline double thread_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// An end of the processor time that a thread and the children that it waits for may take.
class Deadline {
public:
  Deadline() = default;  ///< none
  /// `seconds` from now, >= 0.
  explicit Deadline(double seconds) : end_(thread_seconds() + kSlower * seconds) {}
  /// Seconds that a child of this thread took.
  void spend(double seconds) { end_ -= seconds; }
  [[nodiscard]] double left() const { return end_ - thread_seconds(); }
  [[nodiscard]] bool passed() const { return left() < 0; }
  /// Throws Error(numerical) where it has passed.
  void check() const {
    if (passed()) throw Error(ExitCode::numerical, "time limit reached");
  }

private:
#ifdef __SANITIZE_ADDRESS__
  static constexpr double kSlower = 20;
#else
  static constexpr double kSlower = 1;
#endif
  double end_ = std::numeric_limits<double>::infinity();
};

/// Limits of a solve, over all its stages.
struct SolveLimits {
  Deadline* deadline = nullptr;                                   ///< null: none
  double factor_bytes = std::numeric_limits<double>::infinity();  ///< of a Cholesky factor

  [[nodiscard]] bool out_of_time() const { return deadline != nullptr && deadline->passed(); }
};

}  // namespace palpate
