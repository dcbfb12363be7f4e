// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/front/usb_host.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

namespace palpate::test {

namespace {

constexpr std::uint8_t kInput = 0x80, kTypeMask = 0x60;
constexpr std::size_t kSetup = 8;

/// The status of an ended transfer, as the kernel writes it.
int status_of(Answer answer) {
  switch (answer) {
    case Answer::stalled:
      return -EPIPE;
    case Answer::gone:
      return -ESHUTDOWN;
    default:
      return 0;
  }
}

}  // namespace

int UsbHost::submit(double time, Transfer transfer) {
  if (port_.gone()) return ENODEV;
  pending_.push_back(std::move(transfer));
  advance(time);
  return 0;
}

int UsbHost::discard(const void* urb) {
  const auto found =
      std::find_if(pending_.begin(), pending_.end(), [&](const Transfer& each) { return each.urb == urb; });
  if (found == pending_.end()) return EINVAL;
  found->status = -ENOENT;
  ended_.push_back(std::move(*found));
  pending_.erase(found);
  return 0;
}

bool UsbHost::advance(double time) {
  // An endpoint's transfers end in the order in which they were submitted: the first that waits holds up the others.
  std::uint64_t held = 0;
  const auto bit = [](const Transfer& each) {
    return std::uint64_t{1} << ((each.endpoint & 0x0f) + ((each.endpoint & kInput) != 0 ? 16 : 0));
  };
  for (auto each = pending_.begin(); each != pending_.end();) {
    if ((held & bit(*each)) == 0 && end(time, *each)) {
      ended_.push_back(std::move(*each));
      each = pending_.erase(each);
    } else {
      held |= bit(*each);
      ++each;
    }
  }
  return !ended_.empty();
}

bool UsbHost::end(double time, Transfer& transfer) {
  Answer answer = Answer::pending;
  if (transfer.control) {
    ControlRequest request;
    const Bytes& setup = transfer.bytes;
    const auto word = [&](std::size_t at) { return static_cast<std::uint16_t>(setup[at] | setup[at + 1] << 8); };
    request.request_type = setup[0];
    request.request = setup[1];
    request.value = word(2);
    request.index = word(4);
    request.data.assign(setup.begin() + kSetup, setup.end());
    Bytes reply;
    answer = port_.control(time, request, reply);
    transfer.length = static_cast<int>(setup.size() - kSetup);
    if ((request.request_type & kInput) != 0) {
      transfer.length = static_cast<int>(reply.size());
      transfer.bytes = std::move(reply);
    }
  } else if ((transfer.endpoint & kInput) != 0) {
    Bytes packet;
    answer = port_.read(time, packet);
    const auto room = static_cast<std::size_t>(transfer.room);
    if (answer == Answer::done && packet.size() > room) {
      transfer.status = -EOVERFLOW;
      packet.resize(room);
    }
    transfer.length = static_cast<int>(packet.size());
    transfer.bytes = std::move(packet);
  } else {
    answer = port_.written(time, transfer.bytes);
    transfer.length = answer == Answer::done ? static_cast<int>(transfer.bytes.size()) : 0;
  }
  if (answer == Answer::pending) return false;
  if (answer != Answer::done) transfer.status = status_of(answer);
  return true;
}

bool UsbHost::fetch(Transfer& transfer) {
  if (ended_.empty()) return false;
  transfer = std::move(ended_.front());
  ended_.pop_front();
  return true;
}

int UsbHost::control(double time, const ControlRequest& request, Bytes& reply) {
  constexpr std::uint8_t kGetConfiguration = 8;
  if (port_.gone()) return -ENODEV;
  if ((request.request_type & kTypeMask) == 0) {
    if (request.request_type != kInput || request.request != kGetConfiguration) return -EPIPE;
    reply = {1};
    return 1;
  }
  const Answer answer = port_.control(time, request, reply);
  if (answer != Answer::done) return status_of(answer);
  return static_cast<int>((request.request_type & kInput) != 0 ? reply.size() : request.data.size());
}

}  // namespace palpate::test
