// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/front/usbfs.hpp"

#include "device/device.hpp"
#include "tests/device/front/descriptors.hpp"

#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdarg>
#include <cstdlib>
#include <map>

namespace palpate::test {

namespace {

std::mutex& table_mutex() {
  static std::mutex mutex;
  return mutex;
}

std::map<int, Usbfs*>& table() {
  static std::map<int, Usbfs*> descriptors;
  return descriptors;
}

Usbfs* find(int descriptor) {
  const std::lock_guard<std::mutex> lock(table_mutex());
  const auto found = table().find(descriptor);
  return found == table().end() ? nullptr : found->second;
}

void check(bool ok) {
  if (!ok) std::abort();  // the system has no descriptors left: nothing can be tested
}

}  // namespace

Usbfs::Usbfs(UsbPort& port) : calls_(port) {
  port.plug(device::now());
  const Bytes bytes = descriptors(port.shape());
  descriptor_ = memfd_create("usbfs", MFD_CLOEXEC);
  event_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  check(descriptor_ >= 0 && event_ >= 0);
  check(::write(descriptor_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  lseek(descriptor_, 0, SEEK_SET);
  signal(false);
  calls_.on_ready = [this](bool ready) { signal(ready); };
  // libusb has read the descriptors by then, and waits on what stands in their place from there on.
  calls_.on_opened = [this] { check(dup2(event_, descriptor_) == descriptor_); };
  {
    const std::lock_guard<std::mutex> lock(table_mutex());
    table()[descriptor_] = this;
  }
  port.on_change([this] {
    const std::lock_guard<std::mutex> lock(mutex_);
    stirred_ = true;
    change_.notify_one();
  });
  bus_ = std::thread([this] { run(); });
}

Usbfs::~Usbfs() {
  calls_.port().on_change({});
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
    change_.notify_one();
  }
  bus_.join();
  {
    const std::lock_guard<std::mutex> lock(table_mutex());
    table().erase(descriptor_);
  }
  ::close(descriptor_);
  ::close(event_);
}

void Usbfs::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stop_) {
    calls_.advance();
    // Nobody looks at an endless pause: the next transfer stirs.
    const double pause = std::clamp(calls_.port().due() - device::now(), 0.0, 0.01);
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(std::max(pause, 20e-6));
    change_.wait_until(lock, std::chrono::time_point_cast<std::chrono::steady_clock::duration>(until),
                       [this] { return stop_ || stirred_; });
    stirred_ = false;
  }
}

void Usbfs::signal(bool ready) {
  if (ready == ready_) return;
  ready_ = ready;
  // A counter that holds its most is not ready for output; read back to zero it is.
  std::uint64_t count = ~std::uint64_t{0} - 1;
  check((ready ? ::read(event_, &count, sizeof count) : ::write(event_, &count, sizeof count)) == sizeof count);
}

int Usbfs::answer(unsigned long request, void* argument) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return calls_.answer(request, argument);
}

void Usbfs::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  calls_.take();
}

bool Usbfs::kernel_driver() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return calls_.kernel_driver();
}

bool Usbfs::claimed() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return calls_.claimed();
}

}  // namespace palpate::test

// libusb's calls bind to the executable's own ioctl().
extern "C" int ioctl(int descriptor, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  palpate::test::Usbfs* usbfs = palpate::test::find(descriptor);
  if (usbfs == nullptr) return static_cast<int>(syscall(SYS_ioctl, descriptor, request, argument));
  const int result = usbfs->answer(request, argument);
  if (result >= 0) return result;
  errno = -result;
  return -1;
}
