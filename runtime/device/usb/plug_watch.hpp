// SPDX-License-Identifier: MIT
// Known haptic devices that come and go.
#pragma once

#include "device/usb/enumerate.hpp"

#include <memory>
#include <string>
#include <vector>

namespace palpate::device {

struct PlugEvent {
  bool arrived = false;  ///< gone otherwise
  FoundDevice device;
};

/// Watches every bus, by libusb's hot-plug events where the system has them and by looking again and again where not.
/// It has no thread: events are found inside wait(). Not for a force loop.
class PlugWatch {
public:
  enum class By {
    events,  ///< where there are such; looking otherwise
    looking  ///< every 0.2 s: for containers, where events do not arrive though the system says so
  };
  explicit PlugWatch(By by = By::events);
  ~PlugWatch();
  PlugWatch(const PlugWatch&) = delete;
  PlugWatch& operator=(const PlugWatch&) = delete;

  /// Why nothing can be watched; empty: all is well.
  [[nodiscard]] const std::string& error() const;

  /// Devices plugged in and removed since the last call; waits up to `seconds` for one. Devices present at the
  /// beginning count as plugged in.
  std::vector<PlugEvent> wait(double seconds);

private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate::device
