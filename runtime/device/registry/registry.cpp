// SPDX-License-Identifier: MIT
#include "device/registry/registry.hpp"

#include "device/falcon/falcon_protocol.hpp"
#include "device/open_link/open_link_protocol.hpp"

#include <algorithm>
#include <utility>

namespace palpate::device {

namespace {

std::unique_ptr<Protocol> make_wooden(const DeviceKind&, const DriverOptions& options, std::string& error) {
  if (const char* wrong = options.wooden.validate()) {
    error = wrong;
    return nullptr;
  }
  return std::make_unique<WoodenProtocol>(options.wooden);
}

std::unique_ptr<Protocol> make_falcon(const DeviceKind&, const DriverOptions& options, std::string& error) {
  falcon::Firmware firmware;
  if (!options.falcon_firmware.empty()) firmware = falcon::read_firmware(options.falcon_firmware);
  error = firmware.error;
  return error.empty() ? std::make_unique<FalconProtocol>(std::move(firmware.bytes)) : nullptr;
}

std::unique_ptr<Protocol> make_open_link(const DeviceKind&, const DriverOptions&, std::string&) {
  return std::make_unique<OpenLinkProtocol>();
}

constexpr Driver kDrivers[] = {
    {"falcon", make_falcon},
    {"open-link", make_open_link},
    {"wooden", make_wooden},
};

}  // namespace

const Driver* find_driver(const DeviceKind& kind) {
  const auto* end = std::end(kDrivers);
  const auto* found = std::find_if(std::begin(kDrivers), end,
                                   [&](const Driver& driver) { return std::string_view(kind.driver) == driver.name; });
  return found == end ? nullptr : found;
}

UsbDevice::Opened open_device(std::string_view name, const DriverOptions& drivers, const UsbOptions& options) {
  const auto called = [&](const DeviceKind& kind) { return name.empty() || is_called(kind, name); };
  if (std::none_of(std::begin(kDevices), std::end(kDevices), called)) {
    return {nullptr, Fault::refused, "no known device is called \"" + std::string(name) + "\""};
  }
  const Enumeration seen = enumerate();
  if (!seen.ok) return {nullptr, Fault::refused, seen.error};
  for (const FoundDevice& found : seen.found) {
    if (!called(*found.kind)) continue;
    const Driver* driver = find_driver(*found.kind);
    if (driver == nullptr) {
      return {nullptr, Fault::refused, std::string(found.kind->name) + ": it has no driver"};
    }
    std::string error;
    std::unique_ptr<Protocol> protocol = driver->make(*found.kind, drivers, error);
    if (!protocol) return {nullptr, Fault::refused, std::string(found.kind->name) + ": " + error};
    return UsbDevice::open(*found.kind, {found.bus, found.address}, std::move(protocol), options);
  }
  return {nullptr, Fault::unplugged,
          name.empty() ? "no known haptic device is plugged in" : "no \"" + std::string(name) + "\" is plugged in"};
}

}  // namespace palpate::device
