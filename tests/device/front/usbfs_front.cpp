// SPDX-License-Identifier: GPL-3.0-or-later
// Front end B as a socket: devices are adopted by their file descriptors, which no enumeration finds.
#include "tests/device/front/front.hpp"
#include "tests/device/front/usbfs.hpp"

namespace palpate::test {

namespace {

class UsbfsFront final : public Front {
public:
  void plug(UsbPort& port) override {
    usbfs_ = nullptr;  // one after the other: they share the port
    usbfs_ = std::make_unique<Usbfs>(port);
    port_ = &port;
  }
  void unplug() override { port_->unplug(); }
  device::UsbDevice::Opened open(const device::DeviceKind& kind, const device::DriverOptions& drivers,
                                 const device::UsbOptions& options) override {
    std::string error;
    std::unique_ptr<device::Protocol> protocol = device::find_driver(kind)->make(kind, drivers, error);
    if (!protocol) return {nullptr, device::Fault::refused, error};
    return device::UsbDevice::adopt(usbfs_->descriptor(), kind, std::move(protocol), options);
  }
  void take() override { usbfs_->take(); }
  [[nodiscard]] bool claimed() const override { return usbfs_->claimed(); }
  [[nodiscard]] bool is_prompt() const override { return true; }

private:
  std::unique_ptr<Usbfs> usbfs_;
  UsbPort* port_ = nullptr;
};

}  // namespace

std::unique_ptr<Front> make_front() { return std::make_unique<UsbfsFront>(); }

}  // namespace palpate::test
