// SPDX-License-Identifier: MIT
// Whether a response file is safe to touch with a device, and what makes it so.
#pragma once

#include "device/simulation/sim_device.hpp"
#include "device/stability/file_stiffness.hpp"
#include "device/stability/stability.hpp"

namespace palpate::device {

struct SafetyOptions {
  LoopTiming timing;
  double scale = 1;         ///< DeviceFrame::scale times DeviceFrame::force_scale: N/m in the hand per N/m of the scene
  double amplitude = 1e-3;  ///< m, of the oscillation whose onset is computed for a given hand
  double damping = 0;       ///< N s/m in the hand, at least 0: of a virtual coupling
  std::optional<std::string> validate() const;
};

/// The figures of a file on a device; N/m in the hand.
struct Safety {
  FileStiffness file;        ///< of the scene, unscaled
  double stiffness = 0;      ///< the file's, in the hand
  PassiveStiffness passive;  ///< for any hand
  Onset onset;               ///< in the plant's own hand
  /// A fifth below the onset: that far predicted and simulated onsets agree (tests/device/stability/stability.md).
  [[nodiscard]] bool settles() const { return stiffness * 1.2 < onset.stiffness; }
  [[nodiscard]] bool passive_for_any_hand() const { return stiffness <= passive.least(); }
  /// Largest scale (SafetyOptions::scale) that is safe for any hand.
  double largest_scale = 0;
  /// Stiffest spring between device and tool (runtime::VirtualCoupling) that is: with the contact in line it is as
  /// stiff as the bound, less what the coupling's damping takes of it. Infinite where none is needed, 0 where none is
  /// soft enough.
  double largest_coupling = 0;
};

/// Looks at every response of the file (the cost of some hundred evaluations each). `plant` stands for the device, its
/// hand for a usual grip; both and the options must be usable.
Safety safety(const runtime::View& view, const PlantOptions& plant, const SafetyOptions& options);

}  // namespace palpate::device
