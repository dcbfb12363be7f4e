// SPDX-License-Identifier: GPL-3.0-or-later
// Front end A as a socket: devices are found by enumeration and opened by their names.
#include "tests/device/front/front.hpp"
#include "tests/device/front/mock_bus.hpp"

namespace palpate::test {

namespace {

class MockFront final : public Front {
public:
  ~MockFront() override { pull(); }
  void plug(UsbPort& port) override {
    pull();
    bus_.plug(port, ++address_);
    plugged_ = true;
  }
  void unplug() override { pull(); }
  device::UsbDevice::Opened open(const device::DeviceKind& kind, const device::DriverOptions& drivers,
                                 const device::UsbOptions& options) override {
    return device::open_device(kind.key, drivers, options);
  }
  void take() override { bus_.take(address_); }
  [[nodiscard]] bool claimed() const override { return bus_.claimed(address_); }
  [[nodiscard]] bool is_prompt() const override { return false; }

private:
  void pull() {
    if (plugged_) bus_.unplug(address_);
    plugged_ = false;
  }

  MockBus bus_;
  int address_ = 0;  // a new one each time, as in the kernel
  bool plugged_ = false;
};

}  // namespace

std::unique_ptr<Front> make_front() { return MockBus::possible() ? std::make_unique<MockFront>() : nullptr; }

}  // namespace palpate::test
