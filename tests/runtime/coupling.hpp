// SPDX-License-Identifier: GPL-3.0-or-later
// Couplings, and the loops of a hand that holds one.
#pragma once

#include <cmath>

#include "tests/runtime/support.hpp"

namespace palpate::coupling_test {

using namespace test;
using runtime::Contact;
using runtime::CouplingOptions;
using runtime::VirtualCoupling;

inline constexpr double kTick = 1e-3;

inline CouplingOptions coupling(double stiffness, double damping = 0) {
  CouplingOptions options;
  options.stiffness = stiffness;
  options.damping = damping;
  return options;
}

/// What the hand gave in all loops from free space to free space, and the most that it got back in one.
struct Loops {
  double taken = 0, given = 0, work = 0;
  int touches = 0;
  Vec3 at, felt;

  void add(const Vec3& at_now, const Vec3& force) {
    work += 0.5 * dot(felt + force, at_now - at);
    if (!(length(force) > 0) && length(felt) > 0) {
      ++touches;
      taken += std::fmax(-work, 0);
      given = std::fmax(given, work);
      work = 0;
    }
    at = at_now;
    felt = force;
  }
};

}  // namespace palpate::coupling_test
