// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/front/mock_bus.hpp"

#include "device/device.hpp"
#include "tests/device/front/descriptors.hpp"
#include "tests/device/front/usbfs_calls.hpp"

#include <sys/ioctl.h>
// The macros of usbfs want the line above.
#include <umockdev.h>

#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace palpate::test {

namespace {

std::string file_of(int address) {
  char text[64];
  std::snprintf(text, sizeof text, "/dev/bus/usb/001/%03d", address);
  return text;
}

std::string hex(const Bytes& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    text += digits;
  }
  return text;
}

/// One device file.
struct Plugged {
  explicit Plugged(UsbPort& port) : calls(port) {}

  /// Runs in umockdev's thread. It lives in the program's own process: arguments are pointers into this one.
  static gboolean answer(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
    auto& self = *static_cast<Plugged*>(user);
    UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
    void* pointer = *reinterpret_cast<void**>(argument->data);
    const std::lock_guard<std::mutex> lock(self.mutex);
    self.calls.advance();
    const int result = self.calls.answer(umockdev_ioctl_client_get_request(client), pointer);
    umockdev_ioctl_client_complete(client, result < 0 ? -1 : result, result < 0 ? -result : 0);
    return TRUE;
  }

  std::mutex mutex;
  UsbfsCalls calls;
  UMockdevIoctlBase* handler = nullptr;
};

}  // namespace

struct MockBus::State {
  UMockdevTestbed* bed = nullptr;
  std::map<int, std::unique_ptr<Plugged>> plugged;
  std::vector<std::pair<int, std::unique_ptr<Plugged>>> pulled;  // programs may have them open still
};

bool MockBus::possible() {
  // umockdev caches its first answer, and no testbed works without the wrapper, so the call is made with a testbed.
  static const bool answer = [] {
    UMockdevTestbed* bed = umockdev_testbed_new();
    const bool inside = umockdev_in_mock_environment() == TRUE;
    g_object_unref(bed);
    return inside;
  }();
  return answer;
}

MockBus::MockBus() : state_(std::make_unique<State>()) { state_->bed = umockdev_testbed_new(); }

MockBus::~MockBus() {
  while (!state_->plugged.empty()) unplug(state_->plugged.begin()->first);
  for (const auto& [address, plugged] : state_->pulled) {
    umockdev_testbed_detach_ioctl(state_->bed, file_of(address).c_str(), nullptr);
    g_object_unref(plugged->handler);
  }
  g_object_unref(state_->bed);
}

void MockBus::plug(UsbPort& port, int address) {
  port.plug(device::now());
  auto plugged = std::make_unique<Plugged>(port);
  plugged->handler = umockdev_ioctl_base_new();
  g_signal_connect_after(plugged->handler, "handle-ioctl", G_CALLBACK(Plugged::answer), plugged.get());
  const std::string file = file_of(address);
  // The handler is there before the device is: whoever sees the event may open at once.
  umockdev_testbed_attach_ioctl(state_->bed, file.c_str(), plugged->handler, nullptr);
  const std::string text =
      "P: /devices/usb" + std::to_string(address) + "\nN: " + file.substr(5) +
      "\nE: SUBSYSTEM=usb\nE: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM=" + file.substr(file.size() - 3) +
      "\nE: DEVNAME=" + file + "\nE: DEVTYPE=usb_device\nA: bConfigurationValue=1\\n\n" +
      "A: busnum=1\\n\nA: devnum=" + std::to_string(address) + "\\n\nA: speed=12\\n\n" +
      "H: descriptors=" + hex(descriptors(port.shape())) + "\n";
  umockdev_testbed_add_from_string(state_->bed, text.c_str(), nullptr);
  state_->plugged[address] = std::move(plugged);
}

void MockBus::unplug(int address) {
  Plugged& plugged = *state_->plugged.at(address);
  plugged.calls.port().unplug();
  const std::string path = "/sys/devices/usb" + std::to_string(address);
  umockdev_testbed_uevent(state_->bed, path.c_str(), "remove");
  umockdev_testbed_remove_device(state_->bed, path.c_str());
  state_->pulled.emplace_back(address, std::move(state_->plugged.at(address)));
  state_->plugged.erase(address);
}

void MockBus::take(int address) {
  Plugged& plugged = *state_->plugged.at(address);
  const std::lock_guard<std::mutex> lock(plugged.mutex);
  plugged.calls.take();
}

bool MockBus::claimed(int address) const {
  Plugged& plugged = *state_->plugged.at(address);
  const std::lock_guard<std::mutex> lock(plugged.mutex);
  return plugged.calls.claimed();
}

}  // namespace palpate::test
