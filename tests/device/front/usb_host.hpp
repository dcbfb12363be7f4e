// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel's half of usbfs for one port: transfers that wait, end, and are fetched. Front ends carry it to libusb.
#pragma once

#include "tests/device/models/usb_port.hpp"

#include <cstdint>
#include <deque>
#include <vector>

namespace palpate::test {

/// One pending or ended transfer.
struct Transfer {
  void* urb = nullptr;  ///< where the program keeps its struct
  bool control = false;
  std::uint8_t endpoint = 0;
  int room = 0;    ///< bytes that the program has place for
  Bytes bytes;     ///< what is sent (with the setup of a control transfer), then what has come
  int status = 0;  ///< 0 or a negative error number, as usbfs gives it
  int length = 0;  ///< bytes moved
};

/// Not locked: its front end is.
class UsbHost {
public:
  explicit UsbHost(UsbPort& port) : port_(port) {}

  /// 0, or an error number.
  int submit(double time, Transfer transfer);
  /// Calls back the transfer at `urb`; it ends with -ENOENT. EINVAL: it is not pending.
  int discard(const void* urb);
  /// Lets transfers end that can; true when something waits to be fetched.
  bool advance(double time);
  /// The next ended one; false: none.
  bool fetch(Transfer& transfer);
  /// A control transfer at once (USBDEVFS_CONTROL); bytes, or a negative error number.
  int control(double time, const ControlRequest& request, Bytes& reply);

  [[nodiscard]] UsbPort& port() { return port_; }

private:
  /// False: still pending.
  bool end(double time, Transfer& transfer);

  UsbPort& port_;
  std::vector<Transfer> pending_;
  std::deque<Transfer> ended_;
};

}  // namespace palpate::test
