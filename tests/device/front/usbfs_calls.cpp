// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/front/usbfs_calls.hpp"

#include "device/device.hpp"

#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace palpate::test {

namespace {

constexpr std::uint8_t kInputBit = 0x80;
constexpr std::size_t kSetupBytes = 8;

std::uint8_t* bytes_of(const usbdevfs_urb& urb) { return static_cast<std::uint8_t*>(urb.buffer); }

}  // namespace

void UsbfsCalls::advance() { on_ready(host_.advance(device::now())); }

int UsbfsCalls::answer(unsigned long request, void* argument) {
  if (port().gone() && request != USBDEVFS_REAPURBNDELAY && request != USBDEVFS_DISCARDURB) return -ENODEV;
  switch (request) {
    case USBDEVFS_CONNECTINFO:
      *static_cast<usbdevfs_connectinfo*>(argument) = {1, 0};
      return 0;
    case USBDEVFS_GET_SPEED:
      return 2;  // full
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION |
                                               USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      on_opened();
      return 0;
    case USBDEVFS_CONTROL:
      return control(*static_cast<usbdevfs_ctrltransfer*>(argument));
    case USBDEVFS_GETDRIVER:
      if (!driver_ && !claimed_) return -ENODATA;
      std::strcpy(static_cast<usbdevfs_getdriver*>(argument)->driver, driver_ ? "usbhid" : "usbfs");
      return 0;
    case USBDEVFS_IOCTL:
      return driver(*static_cast<usbdevfs_ioctl*>(argument));
    case USBDEVFS_DISCONNECT_CLAIM:
      if (!taken_) driver_ = false;
      return claim();
    case USBDEVFS_CLAIMINTERFACE:
      return *static_cast<unsigned int*>(argument) == 0 ? claim() : -EINVAL;
    case USBDEVFS_RELEASEINTERFACE:
      return std::exchange(claimed_, false) ? 0 : -EINVAL;
    case USBDEVFS_CLEAR_HALT:
      port().clear_halt(static_cast<std::uint8_t>(*static_cast<unsigned int*>(argument)));
      return 0;
    case USBDEVFS_SUBMITURB:
      return submit(static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_DISCARDURB: {
      const int code = host_.discard(argument);
      advance();
      return -code;
    }
    case USBDEVFS_REAPURBNDELAY:
      return reap(static_cast<void**>(argument));
    default:
      return -ENOTTY;
  }
}

int UsbfsCalls::claim() {
  if (driver_ || taken_) return -EBUSY;
  claimed_ = true;
  return 0;
}

int UsbfsCalls::driver(const usbdevfs_ioctl& call) {
  const bool attach = call.ioctl_code == static_cast<int>(USBDEVFS_CONNECT);
  if (!attach && call.ioctl_code != static_cast<int>(USBDEVFS_DISCONNECT)) return -ENOTTY;
  if (attach && claimed_) return -EBUSY;
  if (!attach && !driver_) return -ENODATA;
  driver_ = attach;
  return attach ? 1 : 0;
}

int UsbfsCalls::control(const usbdevfs_ctrltransfer& transfer) {
  ControlRequest asked{transfer.bRequestType, transfer.bRequest, transfer.wValue, transfer.wIndex, {}};
  auto* data = static_cast<std::uint8_t*>(transfer.data);
  if ((transfer.bRequestType & kInputBit) == 0) asked.data.assign(data, data + transfer.wLength);
  Bytes reply;
  const int result = host_.control(device::now(), asked, reply);
  std::copy_n(reply.begin(), std::min<std::size_t>(reply.size(), transfer.wLength), data);
  return result;
}

int UsbfsCalls::submit(usbdevfs_urb* urb) {
  if (!claimed_ && urb->type != USBDEVFS_URB_TYPE_CONTROL) return -ENOENT;
  Transfer transfer;
  transfer.urb = urb;
  transfer.control = urb->type == USBDEVFS_URB_TYPE_CONTROL;
  transfer.endpoint = urb->endpoint;
  transfer.room = urb->buffer_length;
  const bool input = !transfer.control && (urb->endpoint & kInputBit) != 0;
  if (!input) transfer.bytes.assign(bytes_of(*urb), bytes_of(*urb) + urb->buffer_length);
  const int code = host_.submit(device::now(), std::move(transfer));
  advance();
  return -code;
}

int UsbfsCalls::reap(void** urb) {
  Transfer transfer;
  if (!host_.fetch(transfer)) return port().gone() ? -ENODEV : -EAGAIN;
  auto* program = static_cast<usbdevfs_urb*>(transfer.urb);
  program->status = transfer.status;
  program->actual_length = transfer.length;
  const std::uint8_t direction = transfer.control ? bytes_of(*program)[0] : program->endpoint;
  if ((direction & kInputBit) != 0) {
    std::copy(transfer.bytes.begin(), transfer.bytes.end(), bytes_of(*program) + (transfer.control ? kSetupBytes : 0));
  }
  *urb = program;
  advance();
  return 0;
}

}  // namespace palpate::test
