// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a run of `palpate drive`: a device over a body, and the source that computes forces from its samples.
#pragma once

#include <memory>
#include <optional>

#include "device/loop/force_source.hpp"
#include "device/recording/run_hand.hpp"
#include "tools/drive/drive_coupling.hpp"
#include "tools/drive/drive_device.hpp"
#include "tools/drive/drive_frame.hpp"

namespace palpate::cli {

struct StationOptions {
  DriveDeviceOptions device;
  FrameOptions placing;
  CouplingArguments coupling;
  double limit = 3;      ///< N, of a force or of a glove's pull
  bool single = false;  ///< the nearest wall alone is felt, as by a glove's fingertips
};

struct Station {
  runtime::DeviceFrame frame;
  std::optional<runtime::CouplingOptions> coupling;  ///< in the hand
  bool several = false;                              ///< the tool is felt at several places
  std::optional<device::RunHand> hand;               ///< of a glove: as it was calibrated
  std::unique_ptr<device::ForceSource> source;
  std::unique_ptr<device::Device> device;  ///< open
};

/// The view must outlive it. A glove's hand is calibrated by its extreme poses first. Throws Error as place_device(),
/// choose_coupling() and open_drive_device() do; for a glove also Error(usage) with a coupling, with several
/// places or a tool that is no sphere, and Error(numerical) where its hand cannot be calibrated.
Station set_up(const runtime::View& view, std::uint32_t tool, const device::DeviceKind& kind,
               const StationOptions& options, const Globals& globals);

}  // namespace palpate::cli
