// SPDX-License-Identifier: MIT
// A force loop closed over a simulated device: does a contact, swung a little, come to rest?
#pragma once

#include "device/stability/stability.hpp"

namespace palpate::device {

/// Force (N) at a position that the loop sees (m), a tick (s) after the last; both in the device's frame.
using Response = std::function<Vec3(const Vec3& position, double seconds)>;

/// The hand moves from plant.start to `pressed` and holds. Half the time between `arrive` and `swing` later somebody
/// takes the handle from where it is to `rest`, already swinging more and more, and swings it there for two cycles of a
/// stated amplitude and frequency, so that friction and delays are as in a steady oscillation, and lets go. The handle
/// leaps nowhere: a leap would be work done in no time.
struct Trial {
  PlantOptions plant;  ///< its hand's intent is replaced
  LoopTiming timing;
  Vec3 pressed;                      ///< m
  double arrive = 1.2, swing = 1.4;  ///< s; 0 < arrive < swing
  Vec3 rest;                         ///< m, where contact and hand balance (friction may leave the handle elsewhere)
  Vec3 amplitude;                    ///< m
  double frequency = 20;             ///< Hz; above 0
  Response response;                 ///< may keep a state: one trial runs it
};

/// The handle's motion after it was released.
struct Swing {
  double early = 0, late = 0;  ///< m, amplitude over a quarter second, soon after and 2 s later
  double given = 0;            ///< J, most that the motors had given out at any time, beyond what they had taken in
  double to_hand = 0;          ///< J, the same less what the device's own friction and damping took
  /// Amplitude above two encoder steps, and not decaying over 2 s. Without steps, above 1 um.
  [[nodiscard]] bool oscillates(double resolution) const {
    return late > (resolution > 0 ? 2 * resolution : 1e-6) && late > 0.9 * early;
  }
};

/// Runs one trial. Throws std::invalid_argument where plant, timing, times or frequency are not usable.
Swing run_trial(const Trial& trial);

}  // namespace palpate::device
