// SPDX-License-Identifier: MIT
#include "device/usb/usb_link.hpp"

#include <cstdio>

namespace palpate::device {

namespace {

Fault fault_of(int code) { return code == LIBUSB_ERROR_NO_DEVICE ? Fault::unplugged : Fault::refused; }

LinkResult failed(const DeviceKind& kind, const char* what, int code) {
  return {nullptr, fault_of(code), std::string(kind.name) + ": " + what + ": " + libusb_strerror(code)};
}

LinkResult failed(const DeviceKind& kind, Fault fault, const std::string& what) {
  return {nullptr, fault, std::string(kind.name) + ": " + what};
}

/// Finds the endpoint at `address`, or for 0 the first one in the direction of `direction`, of the given transfer type.
const libusb_endpoint_descriptor* find_endpoint(const libusb_interface_descriptor& setting, std::uint8_t address,
                                                std::uint8_t direction, std::uint8_t type) {
  for (int k = 0; k < setting.bNumEndpoints; ++k) {
    const libusb_endpoint_descriptor& end = setting.endpoint[k];
    const bool here = address != 0 ? end.bEndpointAddress == address : (end.bEndpointAddress & 0x80) == direction;
    if (here && (end.bmAttributes & 0x03) == type) return &end;
  }
  return nullptr;
}

/// Takes the endpoints of the wiring from the active configuration; says what is missing.
const char* find_endpoints(UsbLink& link, const Wiring& wiring) {
  libusb_config_descriptor* configuration = nullptr;
  if (libusb_get_active_config_descriptor(libusb_get_device(link.handle), &configuration) != 0) {
    return "it has no active configuration";
  }
  const char* missing = "it has no such interface";
  for (int k = 0; k < configuration->bNumInterfaces; ++k) {
    if (configuration->interface[k].num_altsetting < 1) continue;
    const libusb_interface_descriptor& setting = configuration->interface[k].altsetting[0];
    if (setting.bInterfaceNumber != wiring.interface) continue;
    const std::uint8_t type = wiring.interrupt ? LIBUSB_TRANSFER_TYPE_INTERRUPT : LIBUSB_TRANSFER_TYPE_BULK;
    const libusb_endpoint_descriptor* in = find_endpoint(setting, wiring.in, LIBUSB_ENDPOINT_IN, type);
    const libusb_endpoint_descriptor* out = find_endpoint(setting, wiring.out, LIBUSB_ENDPOINT_OUT, type);
    missing = in == nullptr ? "it has no such endpoint for input" : "it has no such endpoint for output";
    if (in == nullptr || out == nullptr) break;
    missing = nullptr;
    link.in = in->bEndpointAddress;
    link.out = out->bEndpointAddress;
    link.interrupt = wiring.interrupt;
    // Less than a whole packet would overflow.
    const int packet = in->wMaxPacketSize & 0x7ff;
    if (packet > 0) link.input_size = (wiring.packet + packet - 1) / packet * packet;
  }
  libusb_free_config_descriptor(configuration);
  return missing;
}

/// Claims the interface of an open handle.
LinkResult claim(std::unique_ptr<UsbLink> link, const DeviceKind& kind, const Wiring& wiring) {
  if (const char* missing = find_endpoints(*link, wiring)) return failed(kind, Fault::refused, missing);
  // A system without this option has no driver to detach.
  libusb_set_auto_detach_kernel_driver(link->handle, 1);
  if (const int code = libusb_claim_interface(link->handle, wiring.interface); code != 0) {
    return failed(kind, "its interface could not be claimed", code);
  }
  link->interface = wiring.interface;
  return {std::move(link), Fault::none, {}};
}

bool same_kind(const DeviceKind& kind, libusb_device* device) {
  libusb_device_descriptor descriptor{};
  return libusb_get_device_descriptor(device, &descriptor) == 0 && descriptor.idVendor == kind.vendor &&
         descriptor.idProduct == kind.product;
}

}  // namespace

UsbLink::~UsbLink() {
  close();
  if (context != nullptr) libusb_exit(context);
}

void UsbLink::close() {
  if (interface >= 0) libusb_release_interface(handle, interface);
  interface = -1;
  if (handle != nullptr) libusb_close(handle);
  handle = nullptr;
}

LinkResult open_link(const DeviceKind& kind, UsbPlace place, const Wiring& wiring) {
  auto link = std::make_unique<UsbLink>();
  if (const int code = libusb_init(&link->context); code != 0) return failed(kind, "libusb could not start", code);
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(link->context, &list);
  if (count < 0) return failed(kind, "libusb could not list devices", static_cast<int>(count));
  int code = LIBUSB_ERROR_NO_DEVICE;
  for (ssize_t k = 0; k < count && link->handle == nullptr; ++k) {
    const bool here = (place.bus == 0 && place.address == 0) || (libusb_get_bus_number(list[k]) == place.bus &&
                                                                 libusb_get_device_address(list[k]) == place.address);
    if (here && same_kind(kind, list[k])) code = libusb_open(list[k], &link->handle);
  }
  libusb_free_device_list(list, 1);
  if (link->handle == nullptr) return failed(kind, "it could not be opened", code);
  return claim(std::move(link), kind, wiring);
}

LinkResult adopt_link(int descriptor, const DeviceKind& kind, const Wiring& wiring) {
  auto link = std::make_unique<UsbLink>();
  int code = libusb_init(&link->context);
  if (code != 0) {
    // A system that forbids the search for devices (Android) can still use a descriptor that is handed over.
    libusb_set_option(nullptr, LIBUSB_OPTION_NO_DEVICE_DISCOVERY);
    code = libusb_init(&link->context);
  }
  if (code != 0) return failed(kind, "libusb could not start", code);
  code = libusb_wrap_sys_device(link->context, descriptor, &link->handle);
  if (code != 0) return failed(kind, "the file descriptor is no open USB device", code);
  if (!same_kind(kind, libusb_get_device(link->handle))) {
    return failed(kind, Fault::refused, "the file descriptor belongs to another kind of device");
  }
  return claim(std::move(link), kind, wiring);
}

}  // namespace palpate::device
