// SPDX-License-Identifier: MIT
// An open USB device with its interface claimed: libusb's handles, let go of in the right order.
#pragma once

#include "device/usb/protocol.hpp"
#include "device/usb/usb_device.hpp"

#include <libusb.h>

#include <memory>
#include <string>

namespace palpate::device {

struct UsbLink {
  UsbLink() = default;
  ~UsbLink();
  UsbLink(const UsbLink&) = delete;
  UsbLink& operator=(const UsbLink&) = delete;

  /// Releases the interface and closes the handle; the context goes with the link.
  void close();

  libusb_context* context = nullptr;  ///< its own: no other thread handles its events
  libusb_device_handle* handle = nullptr;
  int interface = -1;  ///< claimed; -1: none
  std::uint8_t in = 0, out = 0;
  bool interrupt = false;
  int input_size = 64;  ///< bytes of a transfer of input: whole packets
};

struct LinkResult {
  std::unique_ptr<UsbLink> link;  ///< null: see below
  Fault fault = Fault::none;
  std::string error;
};

LinkResult open_link(const DeviceKind& kind, UsbPlace place, const Wiring& wiring);
LinkResult adopt_link(int descriptor, const DeviceKind& kind, const Wiring& wiring);

}  // namespace palpate::device
