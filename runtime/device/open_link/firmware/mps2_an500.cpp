// SPDX-License-Identifier: MIT
// An example of a device on the open link: Arm's MPS2 board with a Cortex-M7 (AN500), which QEMU emulates. Its wire is
// UART0; in place of sensors and motors it has a handle of 0.1 kg on a soft spring, computed as it goes. For a board of
// your own keep main(), write the five functions of Handle anew, and take the start-up code that comes with your chip.
#include "device/open_link/firmware/open_link_firmware.hpp"

namespace {

using palpate::device::openlink::Capabilities;
using palpate::device::openlink::Firmware;
using palpate::device::openlink::Measured;

volatile uint32_t& at(uint32_t address) { return *reinterpret_cast<volatile uint32_t*>(address); }

// CMSDK's UART and timer (Arm DDI 0479), both on the board's 25 MHz.
constexpr uint32_t kUart = 0x40004000, kTimer = 0x40000000, kTicksPerMicrosecond = 25;
constexpr uint32_t kData = 0x00, kStatus = 0x04, kControl = 0x08, kDivider = 0x10;
constexpr uint32_t kCannotSend = 1, kHasReceived = 2;

class Handle {
public:
  Handle() {
    at(kUart + kDivider) = 16;  // the fastest
    at(kUart + kControl) = 3;   // sends and receives
    at(kTimer + 0x08) = 0xffffffff;
    at(kTimer + 0x04) = 0xffffffff;
    at(kTimer) = 1;
  }

  uint32_t microseconds() {
    const uint32_t ticks = ~at(kTimer + 0x04);  // it counts down
    spare_ += ticks - ticks_;
    ticks_ = ticks;
    microseconds_ += spare_ / kTicksPerMicrosecond;
    spare_ %= kTicksPerMicrosecond;
    return microseconds_;
  }

  void measure(Measured& measured) {
    const uint32_t now = microseconds();
    for (; now - moved_ >= kStep; moved_ += kStep) move(1e-6F * kStep);
    for (int i = 0; i < 3; ++i) measured.position[i] = position_[i];
    // As a real one would have to be moved first.
    homed_ = homed_ || now > 200000;
    measured.homed = homed_;
  }

  void actuate(const float* force, const float* /*torque*/) {
    for (int i = 0; i < 3; ++i) force_[i] = force[i];
  }

  size_t receive(uint8_t* bytes, size_t most) {
    size_t count = 0;
    while (count < most && (at(kUart + kStatus) & kHasReceived) != 0) {
      bytes[count++] = static_cast<uint8_t>(at(kUart + kData));
    }
    return count;
  }

  void send(const uint8_t* bytes, size_t size) {
    for (size_t i = 0; i < size; ++i) {
      while ((at(kUart + kStatus) & kCannotSend) != 0) {
      }
      at(kUart + kData) = bytes[i];
    }
  }

private:
  static constexpr uint32_t kStep = 100;  // us

  void move(float seconds) {
    constexpr float kMass = 0.1F, kDamping = 2, kSpring = 50;  // kg, N s/m, N/m
    for (int i = 0; i < 3; ++i) {
      velocity_[i] += seconds / kMass * (force_[i] - kDamping * velocity_[i] - kSpring * position_[i]);
      position_[i] += seconds * velocity_[i];
    }
  }

  uint32_t ticks_ = 0, spare_ = 0, microseconds_ = 0, moved_ = 0;
  bool homed_ = false;
  float force_[3] = {}, velocity_[3] = {}, position_[3] = {};
};

Capabilities about() {
  Capabilities c;
  c.peak_force = 3;  // which the spring holds at 60 mm
  c.continuous_force = 3;
  c.stiffness = 500;
  c.radius = 0.11F;
  c.rate = 1000;
  c.watchdog = 0.1F;
  const char name[] = "MPS2 example";
  for (size_t i = 0; i < sizeof name; ++i) c.name[i] = name[i];
  return c;
}

}  // namespace

int main() {
  Handle handle;
  Firmware<Handle> firmware(handle, about());
  for (;;) firmware.step();
}

// Start-up, and what compilers call for copies without a library.
extern "C" {

extern uint32_t stack_top[];

void* memcpy(void* to, const void* from, size_t size) {
  for (size_t i = 0; i < size; ++i) static_cast<volatile uint8_t*>(to)[i] = static_cast<const uint8_t*>(from)[i];
  return to;
}

void* memset(void* to, int value, size_t size) {
  for (size_t i = 0; i < size; ++i) static_cast<volatile uint8_t*>(to)[i] = static_cast<uint8_t>(value);
  return to;
}

[[noreturn]] void reset() {
  at(0xe000ed88) = 0xf << 20;  // CPACR: the floating-point unit may be used
  asm volatile("dsb\n isb");
  main();
  for (;;) {
  }
}

[[noreturn]] void fault() {
  for (;;) {
  }
}

using Entry = void (*)();
__attribute__((section(".vectors"), used))
Entry const vectors[] = {reinterpret_cast<Entry>(stack_top), reset, fault, fault};
}
