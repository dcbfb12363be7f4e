// SPDX-License-Identifier: GPL-3.0-or-later
// A device for `palpate drive` by what it is called, or the one that is plugged in.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "device/simulation/sim_plant.hpp"

namespace palpate::cli {

struct DriveDeviceOptions {
  std::string name;         ///< empty: the one that is plugged in
  double rate = 1000;       ///< Hz of the force loop; a link that takes fewer commands gets as many as it takes
  int priority = 0;         ///< SCHED_FIFO, of the thread that speaks with the device, where permitted; 0: none
  std::string firmware;     ///< path of a maker's file, for devices that load one
  device::Probing probing;  ///< motion of a simulated device's hand
};

/// The kind that the name will open, for its limits. Throws Error(usage) with what there is for a name that nothing
/// has, Error(io) where no such device is plugged in.
const device::DeviceKind& find_drive_kind(const std::string& name);

/// A device with a handle. Throws Error(io) with the cause where it cannot be opened.
std::unique_ptr<device::Device> open_drive_device(const DriveDeviceOptions& options);

/// A device as the list has it.
struct ListedDevice {
  std::string name;       ///< that --device takes
  std::string what;       ///< the product, or what is simulated
  double peak_force = 0;  ///< N
  std::string state;      ///< plugged in, simulated, ...
};

/// The known devices, which of them are plugged in, and the simulated ones.
struct DeviceList {
  std::vector<ListedDevice> devices;
  std::string unseen;  ///< why it is not known what is plugged in; empty: it is
};
DeviceList known_devices();

/// The same as lines.
std::string list_devices();

}  // namespace palpate::cli
