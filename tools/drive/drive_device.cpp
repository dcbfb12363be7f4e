// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/drive/drive_device.hpp"

#include <algorithm>
#include <cstdio>

#include "device/registry/registry.hpp"
#include "device/simulation/sim_device.hpp"
#include "device/simulation/sim_glove.hpp"
#include "formats/io/error.hpp"

namespace palpate::cli {

using device::DeviceKind;

const DeviceKind& find_drive_kind(const std::string& name) {
  if (const device::SimKind* sim = device::find_sim_kind(name)) return sim->kind;
  if (name == device::kSimGlove.name) return device::kSimGlove;
  const auto called = [&](const DeviceKind& kind) { return name.empty() || device::is_called(kind, name); };
  if (std::none_of(std::begin(device::kDevices), std::end(device::kDevices), called)) {
    throw Error(ExitCode::usage, "no device is called '" + name + "'; there are\n" + list_devices());
  }
  const device::Enumeration seen = device::enumerate();
  if (!seen.ok) throw Error(ExitCode::io, seen.error);
  for (const device::FoundDevice& found : seen.found) {
    if (called(*found.kind)) return *found.kind;
  }
  throw Error(ExitCode::io, (name.empty() ? "no known haptic device" : "no '" + name + "'") +
                                " is plugged in ('--device sim' is simulated); there are\n" + list_devices());
}

std::unique_ptr<device::Device> open_drive_device(const DriveDeviceOptions& options) {
  if (const device::SimKind* sim = device::find_sim_kind(options.name)) {
    device::PlantOptions plant = sim->plant;
    plant.hand.intended = options.probing;
    return std::make_unique<device::SimDevice>(sim->kind, plant);
  }
  const DeviceKind& kind = find_drive_kind(options.name);
  device::UsbOptions usb;
  usb.rate = kind.rate > 0 ? std::min(options.rate, kind.rate) : options.rate;
  usb.priority = options.priority;
  device::DriverOptions drivers;
  drivers.falcon_firmware = options.firmware;
  device::UsbDevice::Opened opened = device::open_device(options.name, drivers, usb);
  if (!opened.device) throw Error(ExitCode::io, std::string(kind.name) + ": " + opened.error);
  return std::move(opened.device);
}

DeviceList known_devices() {
  const device::Enumeration seen = device::enumerate();
  DeviceList list;
  for (const DeviceKind& kind : device::kDevices) {
    const bool there = std::any_of(seen.found.begin(), seen.found.end(),
                                   [&](const device::FoundDevice& found) { return found.kind == &kind; });
    const bool driven = device::find_driver(kind) != nullptr;
    list.devices.push_back({kind.key, kind.name, kind.peak_force,
                            !driven ? "has no driver"
                            : there ? "plugged in"
                                    : "not plugged in"});
  }
  for (const device::SimKind& sim : device::sim_kinds()) {
    list.devices.push_back({sim.kind.name, "a device in a hand", sim.kind.peak_force, "simulated"});
  }
  list.devices.push_back({device::kSimGlove.name, "a glove on a hand", device::kSimGlove.peak_force, "simulated"});
  if (!seen.ok) list.unseen = seen.error;
  return list;
}

std::string list_devices() {
  const DeviceList list = known_devices();
  std::string lines;
  for (const ListedDevice& d : list.devices) {
    char line[200];
    std::snprintf(line, sizeof line, "  %-14s %-30s %4.4g N  %s\n", d.name.c_str(), d.what.c_str(), d.peak_force,
                  d.state.c_str());
    lines += line;
  }
  if (!list.unseen.empty()) lines += "  (" + list.unseen + ")\n";
  return lines;
}

}  // namespace palpate::cli
