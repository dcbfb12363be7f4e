// SPDX-License-Identifier: MIT
#include "device/open_link/open_link_codec.hpp"

namespace palpate::device::openlink {
namespace {

constexpr size_t kHelloSize = 2, kDriveSize = 25, kCapabilitiesSize = 50, kStateSize = 40, kNameSize = 16;
constexpr float kLargest = 3.4028235e38F;

bool finite(float value) { return value >= -kLargest && value <= kLargest; }

// Floats go over the wire as the integer of the same bits, whatever order this machine has its bytes in.
uint32_t bits_of(float value) {
  uint32_t bits = 0;
  static_assert(sizeof bits == sizeof value, "binary32");
  const auto* from = reinterpret_cast<const unsigned char*>(&value);
  auto* to = reinterpret_cast<unsigned char*>(&bits);
  for (size_t i = 0; i < sizeof bits; ++i) to[i] = from[i];
  return bits;
}

float float_of(uint32_t bits) {
  float value = 0;
  const auto* from = reinterpret_cast<const unsigned char*>(&bits);
  auto* to = reinterpret_cast<unsigned char*>(&value);
  for (size_t i = 0; i < sizeof value; ++i) to[i] = from[i];
  return value;
}

class Writer {
public:
  Writer(uint8_t sequence, Type type) {
    frame_.bytes[0] = kSync;
    frame_.bytes[1] = type;
    frame_.bytes[3] = sequence;
  }
  Writer& u8(uint8_t value) {
    frame_.bytes[at_++] = value;
    return *this;
  }
  Writer& u32(uint32_t value) {
    for (unsigned shift = 0; shift < 32; shift += 8) u8(static_cast<uint8_t>(value >> shift));
    return *this;
  }
  Writer& f32(float value) { return u32(bits_of(value)); }
  template <size_t n>
  Writer& f32(const float (&values)[n]) {
    for (const float value : values) f32(value);
    return *this;
  }
  Frame done() {
    frame_.bytes[2] = static_cast<uint8_t>(at_ - kHead);
    const uint16_t sum = crc(frame_.bytes + 1, at_ - 1);
    u8(static_cast<uint8_t>(sum)).u8(static_cast<uint8_t>(sum >> 8));
    return frame_;
  }

private:
  Frame frame_;
  size_t at_ = kHead;
};

class Fields {
public:
  explicit Fields(const Frame& frame) : at_(frame.payload()) {}
  uint8_t u8() { return *at_++; }
  uint32_t u32() {
    uint32_t value = 0;
    for (unsigned shift = 0; shift < 32; shift += 8) value |= static_cast<uint32_t>(u8()) << shift;
    return value;
  }
  float f32() { return float_of(u32()); }
  template <size_t n>
  void f32(float (&values)[n]) {
    for (float& value : values) value = f32();
  }

private:
  const uint8_t* at_;
};

bool is(const Frame& frame, Type type, size_t least) { return frame.type() == type && frame.payload_size() >= least; }

bool within(float value, float least, float most) { return value >= least && value <= most; }

}  // namespace

Frame encode(uint8_t sequence, const Hello& hello) {
  return Writer(sequence, kHello).u8(hello.major).u8(hello.minor).done();
}

Frame encode(uint8_t sequence, const Drive& drive) {
  return Writer(sequence, kDrive).u8(drive.on ? 1 : 0).f32(drive.force).f32(drive.torque).done();
}

Frame encode(uint8_t sequence, const Capabilities& c) {
  Writer writer(sequence, kCapabilities);
  writer.u8(c.major).u8(c.minor).u8(c.measures).u8(c.drives).u8(c.buttons).u8(0);
  writer.f32(c.peak_force).f32(c.continuous_force).f32(c.peak_torque).f32(c.stiffness);
  writer.f32(c.radius).f32(c.rate).f32(c.watchdog);
  for (size_t i = 0; i < kNameSize; ++i) writer.u8(static_cast<uint8_t>(c.name[i]));
  return writer.done();
}

Frame encode(uint8_t sequence, const State& s) {
  Writer writer(sequence, kState);
  writer.u32(s.clock).u8(s.flags).u8(s.fault).u8(s.heard).u8(0).u32(s.buttons);
  return writer.f32(s.position).f32(s.orientation).done();
}

bool decode(const Frame& frame, Hello& hello) {
  if (!is(frame, kHello, kHelloSize)) return false;
  Fields fields(frame);
  hello.major = fields.u8();
  hello.minor = fields.u8();
  return true;
}

bool decode(const Frame& frame, Drive& drive) {
  if (!is(frame, kDrive, kDriveSize)) return false;
  Fields fields(frame);
  drive.on = fields.u8() == 1;
  fields.f32(drive.force);
  fields.f32(drive.torque);
  return true;
}

bool decode(const Frame& frame, Capabilities& c) {
  if (!is(frame, kCapabilities, kCapabilitiesSize)) return false;
  Fields fields(frame);
  c.major = fields.u8();
  c.minor = fields.u8();
  c.measures = fields.u8();
  c.drives = fields.u8();
  c.buttons = fields.u8();
  fields.u8();
  float* const values[] = {&c.peak_force, &c.continuous_force, &c.peak_torque, &c.stiffness, &c.radius,
                           &c.rate,       &c.watchdog};
  for (float* value : values) *value = fields.f32();
  for (size_t i = 0; i < kNameSize; ++i) c.name[i] = static_cast<char>(fields.u8());
  c.name[kNameSize] = 0;
  return true;
}

bool decode(const Frame& frame, State& s) {
  if (!is(frame, kState, kStateSize)) return false;
  Fields fields(frame);
  s.clock = fields.u32();
  s.flags = fields.u8();
  s.fault = fields.u8();
  s.heard = fields.u8();
  fields.u8();
  s.buttons = fields.u32();
  fields.f32(s.position);
  fields.f32(s.orientation);
  return true;
}

const char* wrong(const Capabilities& c) {
  constexpr uint8_t kPosition = 0x07, kTorque = 0x38;
  constexpr float kTiny = 1e-9F;
  if ((c.measures & kPosition) != kPosition) return "position x, y, z must be measured";
  if (c.buttons > 32) return "there are at most 32 buttons";
  if (!within(c.peak_force, kTiny, 1000)) return "the peak force is above 0 and at most 1000 N";
  if (!within(c.continuous_force, kTiny, c.peak_force)) return "the continuous force is above 0 and at most the peak";
  if (!within(c.peak_torque, (c.drives & kTorque) != 0 ? kTiny : 0, 100)) {
    return "the peak torque is at most 100 N m, and above 0 where a torque is driven";
  }
  if (!(c.stiffness >= 0 && finite(c.stiffness))) return "the stiffness is finite and not negative";
  if (!within(c.radius, kTiny, 10)) return "the radius is above 0 and at most 10 m";
  if (!within(c.rate, 500, 20000)) return "the rate is from 500 to 20000 a second";
  if (!within(c.watchdog, 0.002F, 0.1F)) return "the watchdog is from 0.002 to 0.1 s";
  return nullptr;
}

void Reader::drop(size_t count) {
  for (size_t i = count; i < filled_; ++i) bytes_[i - count] = bytes_[i];
  filled_ -= count;
}

void Reader::put(uint8_t byte) {
  if (filled_ == kMostFrame) {  // get() was not called: it would have removed a frame or noise
    drop(1);
    ++noise_;
  }
  bytes_[filled_++] = byte;
}

bool Reader::get(Frame& frame) {
  for (;;) {
    size_t noise = 0;
    while (noise < filled_ && bytes_[noise] != kSync) ++noise;
    noise_ += noise;
    drop(noise);
    if (filled_ < kHead) return false;
    const size_t payload = bytes_[2], size = kHead + payload + kCheck;
    if (payload <= kMostPayload) {
      if (filled_ < size) return false;
      const uint16_t sum = crc(bytes_ + 1, size - 1 - kCheck);
      if (bytes_[size - 2] == (sum & 0xff) && bytes_[size - 1] == sum >> 8) {
        for (size_t i = 0; i < size; ++i) frame.bytes[i] = bytes_[i];
        drop(size);
        return true;
      }
    }
    drop(1);  // it was no sync byte
    ++noise_;
  }
}

}  // namespace palpate::device::openlink
