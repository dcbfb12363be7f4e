// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/usb/emulated.hpp"

#include "tests/device/models/falcon_model.hpp"
#include "tests/device/models/open_link_model.hpp"
#include "tests/device/models/wooden_model.hpp"
#include "tests/device/seeded.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace palpate::test {

namespace {

using device::Vec3;

class Wooden final : public Emulated {
public:
  [[nodiscard]] const device::DeviceKind& kind() const override { return device::kDevices[0]; }
  UsbModel& model() override { return model_; }
  [[nodiscard]] device::DriverOptions options(bool patient) const override {
    device::DriverOptions result;
    result.wooden = quick_homing(patient);
    if (wrong_) result.wooden.boot = 0.5;
    return result;
  }
  [[nodiscard]] Vec3 tip() const override { return position(model_.geometry, kHome); }

  // Round and round, never still for as long as homing takes.
  void lose() override {
    model_.motion = [](double time) {
      constexpr double kAround = 20, kFar = 0.03;  // rad/s, rad
      return device::Joints{kHome[0], kHome[1] + kFar * std::cos(kAround * time),
                            kHome[2] + kFar * std::sin(kAround * time)};
    };
  }
  void home() override {
    model_.motion = [](double) { return kHome; };
  }
  void settle() override { home(); }

  void mute() override { model_.frozen = true; }
  void wrap_encoder() override { model_.leap(1 << 15); }
  void wrong_firmware() override {
    wrong_ = true;
    model_.six = true;
  }

  [[nodiscard]] bool pushes(const Bytes& written) const override {
    return std::any_of(written.begin(), written.end(), [](std::uint8_t byte) { return byte != 0; });
  }
  [[nodiscard]] bool says(const Bytes& written, const Vec3& force) const override {
    const device::Joints amps = currents(model_.geometry, kHome, force);
    for (std::size_t k = 0; k < 3; ++k) {
      const int got =
          static_cast<std::int16_t>(static_cast<std::uint16_t>(written.at(2 * k) | written.at(2 * k + 1) << 8));
      if (!(std::fabs(got - 1000 * amps[k]) <= 0.51)) return false;
    }
    return true;
  }
  bool holds_a_force(double time) override { return model_.milliamps(time) != std::array<int, 3>{}; }

private:
  static constexpr device::Joints kHome{0, 0, device::kPi / 2};
  WoodenModel model_;
  bool wrong_ = false;
};

/// Any bytes, in a file: the model takes them for its firmware. Not the maker's.
class FirmwareFile {
public:
  FirmwareFile() {
    const int file = ::mkstemp(path_.data());
    if (file < 0) std::abort();  // nowhere to write to: nothing can be tested
    ::close(file);
    write();
  }
  ~FirmwareFile() { ::unlink(path_.c_str()); }
  FirmwareFile(const FirmwareFile&) = delete;
  FirmwareFile& operator=(const FirmwareFile&) = delete;

  static Bytes right() {
    Seeded random(7);
    Bytes bytes(700);
    for (auto& byte : bytes) byte = random.byte();
    return bytes;
  }
  void spoil() { write(1); }
  [[nodiscard]] const std::string& path() const { return path_; }

private:
  void write(std::uint8_t flip = 0) const {
    Bytes bytes = right();
    bytes.back() ^= flip;
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }

  std::string path_ = (std::filesystem::temp_directory_path() / "falcon-firmware-XXXXXX").string();
};

class Falcon final : public Emulated {
public:
  [[nodiscard]] const device::DeviceKind& kind() const override { return *device::find_kind(0x0403, 0xcb48); }
  UsbModel& model() override { return model_; }
  [[nodiscard]] device::DriverOptions options(bool) const override {
    device::DriverOptions result;
    result.falcon_firmware = file_.path();
    return result;
  }
  [[nodiscard]] Vec3 tip() const override { return model_.tip - device::falcon::kCentre; }

  void lose() override { model_.homed = 0; }
  void home() override { model_.homed = device::falcon::Input::kHomed; }
  void settle() override {
    model_.leave_running({});
    home();
  }

  void mute() override { model_.faults.mute = true; }  // its FTDI chip goes on by itself
  void wrap_encoder() override { model_.faults.shift[0] = 1 << 15; }
  void lose_origin() override { model_.faults.lose_home = true; }
  void wrong_firmware() override { file_.spoil(); }

  [[nodiscard]] bool pushes(const Bytes& written) const override { return motors_in(written) != Motors{}; }
  [[nodiscard]] bool says(const Bytes& written, const Vec3& force) const override {
    using namespace device::falcon;
    const auto expected = motors(torques(inverse(model_.tip), force)), got = motors_in(written);
    // Encoders of finite steps: the driver's arms are not quite the model's.
    return std::equal(got.begin(), got.end(), expected.begin(), [](int a, int b) { return std::abs(a - b) <= 8; });
  }
  bool holds_a_force(double) override { return model_.motors() != Motors{}; }

private:
  using Motors = std::array<std::int16_t, 3>;

  // Zero for bytes that are no packet of motors (boot).
  static Motors motors_in(const Bytes& written) {
    device::falcon::Reader reader;
    Motors motors{};
    for (const std::uint8_t byte : written) {
      if (reader.take(byte)) motors = reader.input().encoders;
    }
    return motors;
  }

  FirmwareFile file_;
  FalconModel model_{FirmwareFile::right()};
};

class OpenLink final : public Emulated {
public:
  OpenLink() {
    // The longest watchdog there may be: the machine may hold the host up.
    model_.capabilities.watchdog = static_cast<float>(kind().watchdog);
    model_.measured.position[0] = 0.02F;
    model_.measured.position[2] = -0.03F;
  }
  [[nodiscard]] const device::DeviceKind& kind() const override { return *device::find_kind(0x1209, 0x0001); }
  UsbModel& model() override { return model_; }
  [[nodiscard]] device::DriverOptions options(bool) const override { return {}; }
  [[nodiscard]] Vec3 tip() const override {
    const auto& p = model_.measured.position;
    return {p[0], p[1], p[2]};
  }

  void lose() override { model_.measured.homed = false; }
  void home() override { model_.measured.homed = true; }
  void settle() override { home(); }

  void mute() override { model_.faults.mute = true; }
  // It measures metres: what its own counter makes of them is out of reach.
  void wrap_encoder() override { model_.measured.position[2] = 0.2F; }
  void lose_origin() override { model_.measured.homed = false; }
  void overheat() override { model_.measured.fault = 1; }
  void wrong_firmware() override { model_.capabilities.major = device::openlink::kMajor + 1; }

  [[nodiscard]] bool pushes(const Bytes& written) const override {
    const device::openlink::Drive drive = drive_in(written);
    return drive.on && (drive.force[0] != 0 || drive.force[1] != 0 || drive.force[2] != 0);
  }
  [[nodiscard]] bool says(const Bytes& written, const Vec3& force) const override {
    const device::openlink::Drive drive = drive_in(written);
    const Vec3 got{drive.force[0], drive.force[1], drive.force[2]};
    return drive.on && length(got - force) < 1e-6;
  }
  bool holds_a_force(double time) override {
    model_.advance(time);
    return time < model_.force_until;
  }

private:
  static device::openlink::Drive drive_in(const Bytes& written) {
    device::openlink::Frame frame;
    std::copy_n(written.begin(), std::min(written.size(), sizeof frame.bytes), frame.bytes);
    device::openlink::Drive drive;
    return decode(frame, drive) ? drive : device::openlink::Drive{};
  }

  OpenLinkModel model_;
};

}  // namespace

device::WoodenOptions quick_homing(bool patient) {
  device::WoodenOptions options;
  options.hold = 0.05;
  if (patient) {
    options.doubtful = 0.5;
    options.silence = 1;
  }
  return options;
}

std::unique_ptr<Emulated> emulated(const std::string& driver) {
  if (driver == "wooden") return std::make_unique<Wooden>();
  if (driver == "falcon") return std::make_unique<Falcon>();
  if (driver == "open-link") return std::make_unique<OpenLink>();
  std::abort();  // a test that names no driver
}

}  // namespace palpate::test
