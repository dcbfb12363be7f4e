// SPDX-License-Identifier: MIT
#include "device/usb/usb_device.hpp"

#include "device/usb/usb_link.hpp"
#include "device/usb/usb_loop.hpp"

#include <utility>

namespace palpate::device {

const char* UsbOptions::validate() const {
  if (!(rate >= 10 && rate <= 20000)) return "the rate of a device is from 10 to 20000 Hz";
  if (!(write_limit > 0 && write_limit <= kStale)) return "a command may take up to 10 ms to leave";
  if (inputs < 2 || inputs > 64) return "2 to 64 transfers of input are queued";
  if (priority < 0 || priority > 99) return "a real-time priority is from 1 to 99, or 0 for none";
  return nullptr;
}

UsbDevice::Opened UsbDevice::open(const DeviceKind& kind, UsbPlace place, std::unique_ptr<Protocol> protocol,
                                  const UsbOptions& options) {
  if (const char* wrong = options.validate()) return {nullptr, Fault::refused, wrong};
  const Wiring wiring = protocol->wiring();
  return run(open_link(kind, place, wiring), kind, std::move(protocol), options);
}

UsbDevice::Opened UsbDevice::adopt(int descriptor, const DeviceKind& kind, std::unique_ptr<Protocol> protocol,
                                   const UsbOptions& options) {
  if (const char* wrong = options.validate()) return {nullptr, Fault::refused, wrong};
  const Wiring wiring = protocol->wiring();
  return run(adopt_link(descriptor, kind, wiring), kind, std::move(protocol), options);
}

UsbDevice::Opened UsbDevice::run(LinkResult link, const DeviceKind& kind, std::unique_ptr<Protocol> protocol,
                                 const UsbOptions& options) {
  if (!link.link) return {nullptr, link.fault, std::move(link.error)};
  auto loop = std::make_unique<UsbLoop>(std::move(link.link), std::move(protocol), kind, options);
  std::string error;
  if (!loop->start(error)) return {nullptr, Fault::refused, std::move(error)};
  return {std::unique_ptr<UsbDevice>(new UsbDevice(kind, std::move(loop))), Fault::none, {}};
}

UsbDevice::UsbDevice(const DeviceKind& kind, std::unique_ptr<UsbLoop> loop) : kind_(kind), loop_(std::move(loop)) {
  seen_.phase = Phase::starting;
}

UsbDevice::~UsbDevice() { loop_->stop(); }

Sample UsbDevice::read() noexcept {
  loop_->samples.read(seen_);
  return seen_;
}

void UsbDevice::write(const Command& command) noexcept { loop_->commands.write(command); }

void UsbDevice::close() { loop_->stop(); }

UsbCounts UsbDevice::counts() const noexcept { return loop_->counts(); }

}  // namespace palpate::device
