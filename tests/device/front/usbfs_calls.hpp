// SPDX-License-Identifier: GPL-3.0-or-later
// Answers of usbfs to a program's ioctl() calls, for one port (linux/usbdevice_fs.h).
#pragma once

#include "tests/device/front/usb_host.hpp"

#include <linux/usbdevice_fs.h>

#include <functional>

namespace palpate::test {

/// Not locked: its front end is. Arguments are the program's own memory.
class UsbfsCalls {
public:
  explicit UsbfsCalls(UsbPort& port) : host_(port), driver_(port.shape().interface_class == 3) {}

  /// 0 or more, or a negative error number.
  int answer(unsigned long request, void* argument);

  /// Lets transfers end that can, and says so to on_ready.
  void advance();

  /// Takes the interface as another program would: claims are refused.
  void take() { taken_ = true; }
  /// Whether a kernel driver has the interface, as usbhid has that of every new HID device.
  [[nodiscard]] bool kernel_driver() const { return driver_; }
  [[nodiscard]] bool claimed() const { return claimed_; }
  [[nodiscard]] UsbPort& port() { return host_.port(); }

  std::function<void(bool)> on_ready = [](bool) {};  ///< something can be reaped, or not
  std::function<void()> on_opened = [] {};           ///< the descriptors have been read

private:
  int claim();
  int driver(const usbdevfs_ioctl& call);
  int control(const usbdevfs_ctrltransfer& transfer);
  int submit(usbdevfs_urb* urb);
  int reap(void** urb);

  UsbHost host_;
  bool driver_, claimed_ = false, taken_ = false;
};

}  // namespace palpate::test
