// SPDX-License-Identifier: GPL-3.0-or-later
// An emulated USB device apart from any wire: its descriptors, bytes in, bytes out. It uses no libusb, no thread and no
// clock, so the same model serves every front end (usbfs in process, umockdev) and plain tests.
#pragma once

#include <cstdint>
#include <vector>

namespace palpate::test {

using Bytes = std::vector<std::uint8_t>;

/// The device at enumeration: one configuration, one interface, an endpoint each way.
struct UsbShape {
  std::uint16_t vendor = 0, product = 0;
  std::uint8_t interface_class = 0xff;  ///< 3: HID; 0xff: the vendor's own
  std::uint8_t in = 0x81, out = 0x01;   ///< endpoint addresses
  bool interrupt = false;               ///< interrupt endpoints; bulk otherwise
  std::uint16_t packet = 64;            ///< wMaxPacketSize
};

/// A control request that is no standard one (those are the front end's).
struct ControlRequest {
  std::uint8_t request_type = 0, request = 0;
  std::uint16_t value = 0, index = 0;
  Bytes data;  ///< of requests to the device
};

/// One device. Its front end calls it from one thread at a time, with times (s) that never go back.
class UsbModel {
public:
  virtual ~UsbModel() = default;
  [[nodiscard]] virtual UsbShape shape() const = 0;

  /// Power comes on: everything as after a reset.
  virtual void plugged(double time) = 0;

  /// Answers a control request; false: it stalls. `reply` is for requests to the host.
  virtual bool control(double time, const ControlRequest& request, Bytes& reply) = 0;

  /// A transfer from the host to the endpoint for output.
  virtual void written(double time, const Bytes& bytes) = 0;

  /// Takes the next packet for the host, at most UsbShape::packet bytes; false: the endpoint has nothing now.
  virtual bool read(double time, Bytes& packet) = 0;

  /// When read() may have something without a request or transfer before (s); infinity: never.
  [[nodiscard]] virtual double due() const = 0;
};

}  // namespace palpate::test
