// SPDX-License-Identifier: GPL-3.0-or-later
// Front end B: usbfs inside the test's own process. The executable that links it answers libusb's ioctl() calls on file
// descriptors that it made itself, so that libusb's own code runs between driver and model.
#pragma once

#include "tests/device/front/usbfs_calls.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>

namespace palpate::test {

class Usbfs {
public:
  /// Plugs the port in. A thread of its own is the bus: it moves packets when they are due.
  explicit Usbfs(UsbPort& port);
  ~Usbfs();
  Usbfs(const Usbfs&) = delete;
  Usbfs& operator=(const Usbfs&) = delete;

  /// For libusb_wrap_sys_device(), once. Valid as long as this.
  [[nodiscard]] int descriptor() const { return descriptor_; }

  /// UsbfsCalls::answer(), one thread at a time.
  int answer(unsigned long request, void* argument);

  /// UsbfsCalls::take().
  void take();
  [[nodiscard]] bool kernel_driver() const;
  [[nodiscard]] bool claimed() const;

private:
  void run();
  /// Makes the descriptor ready for output, as usbfs does when something can be reaped, or not.
  void signal(bool ready);

  UsbfsCalls calls_;
  int descriptor_ = -1, event_ = -1;
  bool ready_ = true;
  bool stop_ = false, stirred_ = false;
  mutable std::mutex mutex_;
  std::condition_variable change_;
  std::thread bus_;
};

}  // namespace palpate::test
