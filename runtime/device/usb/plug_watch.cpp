// SPDX-License-Identifier: MIT
#include "device/usb/plug_watch.hpp"

#include "device/device.hpp"

#include <libusb.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

namespace palpate::device {

namespace {

constexpr double kLookAgain = 0.2;  // s between two looks where there are no events

bool same(const FoundDevice& a, const FoundDevice& b) {
  return a.kind == b.kind && a.bus == b.bus && a.address == b.address;
}

bool contains(const std::vector<FoundDevice>& list, const FoundDevice& device) {
  return std::any_of(list.begin(), list.end(), [&](const FoundDevice& each) { return same(each, device); });
}

}  // namespace

struct PlugWatch::State {
  std::string error;
  libusb_context* context = nullptr;
  bool hotplug = false;
  std::vector<PlugEvent> events;
  std::vector<FoundDevice> known;  // without hot-plug events

  static int LIBUSB_CALL changed(libusb_context*, libusb_device* device, libusb_hotplug_event event, void* user) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != 0) return 0;
    if (const DeviceKind* kind = find_kind(descriptor.idVendor, descriptor.idProduct)) {
      static_cast<State*>(user)->events.push_back(
          {event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED,
           {kind, libusb_get_bus_number(device), libusb_get_device_address(device)}});
    }
    return 0;  // goes on watching
  }

  void look() {
    Enumeration seen = enumerate();
    error = seen.error;
    if (!seen.ok) return;
    for (const FoundDevice& device : known) {
      if (!contains(seen.found, device)) events.push_back({false, device});
    }
    for (const FoundDevice& device : seen.found) {
      if (!contains(known, device)) events.push_back({true, device});
    }
    known = std::move(seen.found);
  }
};

PlugWatch::PlugWatch(By by) : state_(std::make_unique<State>()) {
  State& s = *state_;
  if (const int code = libusb_init(&s.context); code != 0) {
    s.context = nullptr;
    s.error = std::string("libusb could not start: ") + libusb_strerror(code);
    return;
  }
  constexpr int kEvents = LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT;
  s.hotplug = by == By::events && libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) != 0 &&
              libusb_hotplug_register_callback(s.context, kEvents, LIBUSB_HOTPLUG_ENUMERATE, LIBUSB_HOTPLUG_MATCH_ANY,
                                               LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, State::changed, &s,
                                               nullptr) == LIBUSB_SUCCESS;
}

PlugWatch::~PlugWatch() {
  if (state_->context != nullptr) libusb_exit(state_->context);
}

const std::string& PlugWatch::error() const { return state_->error; }

std::vector<PlugEvent> PlugWatch::wait(double seconds) {
  State& s = *state_;
  const double end = now() + seconds;
  while (s.context != nullptr) {
    const double left = std::max(end - now(), 0.0);
    if (s.hotplug) {
      // Devices found while registering are returned without waiting.
      const double pause = s.events.empty() ? left : 0;
      timeval most{static_cast<time_t>(pause),
                   static_cast<suseconds_t>((pause - static_cast<double>(static_cast<time_t>(pause))) * 1e6)};
      libusb_handle_events_timeout_completed(s.context, &most, nullptr);
    } else {
      s.look();
      if (s.events.empty()) std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left, kLookAgain)));
    }
    if (!s.events.empty() || now() >= end) break;
  }
  return std::exchange(s.events, {});
}

}  // namespace palpate::device
