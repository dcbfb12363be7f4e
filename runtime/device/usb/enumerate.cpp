// SPDX-License-Identifier: MIT
// Enumeration over libusb 1.0.
#include "device/usb/enumerate.hpp"

#include <libusb.h>

namespace palpate::device {

Enumeration enumerate() {
  Enumeration result;
  libusb_context* context = nullptr;
  if (const int code = libusb_init(&context); code != 0) {
    result.error = std::string("libusb could not start: ") + libusb_strerror(code);
    return result;
  }
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context, &list);
  if (count < 0) {
    result.error = std::string("libusb could not list devices: ") + libusb_strerror(static_cast<int>(count));
  } else {
    result.ok = true;
    for (ssize_t k = 0; k < count; ++k) {
      libusb_device_descriptor descriptor{};
      if (libusb_get_device_descriptor(list[k], &descriptor) != 0) continue;
      if (const DeviceKind* kind = find_kind(descriptor.idVendor, descriptor.idProduct)) {
        result.found.push_back({kind, libusb_get_bus_number(list[k]), libusb_get_device_address(list[k])});
      }
    }
    libusb_free_device_list(list, 1);
  }
  libusb_exit(context);
  return result;
}

}  // namespace palpate::device
