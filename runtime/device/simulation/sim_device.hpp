// SPDX-License-Identifier: MIT
// A simulated device behind the interface of the real ones: life, buttons and faults around a plant.
#pragma once

#include "device/device.hpp"
#include "device/simulation/sim_plant.hpp"

#include <atomic>
#include <string_view>
#include <vector>

namespace palpate::device {

/// A kind of device with the plant that stands for it, held by nobody in particular (the default hand).
struct SimKind {
  DeviceKind kind;  ///< named "sim" or "sim-..."; no USB ids
  PlantOptions plant;
};

/// The simulated kinds, in the order to list them; the first is "sim".
const std::vector<SimKind>& sim_kinds();

/// The kind of this name, or null.
const SimKind* find_sim_kind(std::string_view name);

/// The kind that stands for a real one, or for itself: by its driver. Null where nobody knows its mechanics.
const SimKind* find_stand_in(const DeviceKind& kind);

struct SimOptions {
  double starting = 0.05;              ///< s until the first sample; at least 0
  double homing = 0.25;                ///< s from there until its encoders have an origin; at least 0
  Vec3 unhomed{0.013, -0.008, 0.021};  ///< m, added to what it measures until then
  double silent_after = 0.005;         ///< s without a sample that end it; (0, kStale]
  double longest_gap = 0.5;            ///< s of wall time that are simulated at once; what is beyond is skipped
  std::optional<std::string> validate() const;
};

/// Driven live, it moves on with a clock whenever it is read or written; without a clock only when a caller says so.
/// read() and write() are as Device promises them; their cost grows with the time since the last one (some 20 ms for a
/// second). press() and the faults may come from another thread.
class SimDevice final : public Device {
public:
  using Clock = double (*)();

  /// `kind` must outlive it. Throws std::invalid_argument where plant or options are not usable.
  SimDevice(const DeviceKind& kind, const PlantOptions& plant, const SimOptions& options = {}, Clock clock = &now);

  [[nodiscard]] const DeviceKind& kind() const override { return kind_; }
  Sample read() noexcept override;
  void write(const Command& command) noexcept override;
  void close() override;

  /// Moves on to a time on the clock (s; not back).
  void advance(double to_time) noexcept;

  void press(std::uint32_t buttons) { buttons_ = buttons; }
  /// From here on no sample arrives; the device goes on to take commands.
  void fall_silent() { injected_ = Injected::silence; }
  /// From here on nothing passes either way: it keeps its last force until its own watchdog ends it.
  void unplug() { injected_ = Injected::unplugged; }

  /// The true position, velocity, force and work, without the effects of encoders and link.
  [[nodiscard]] const SimPlant& plant() const { return plant_; }

private:
  enum class Injected : std::uint8_t { none, silence, unplugged };
  void move_on() noexcept;
  [[nodiscard]] double plant_time(double time) const { return time - opened_ - skipped_; }
  [[nodiscard]] Phase phase_at(double time) const;
  void send(double time, const Vec3& force) noexcept;
  void end(Phase phase, Fault fault) noexcept { sample_.phase = phase, sample_.fault = fault; }

  DeviceKind kind_;
  SimOptions options_;
  Clock clock_;
  SimPlant plant_;
  double opened_, time_;  ///< s on the clock
  double skipped_ = 0;    ///< s of it that were not simulated
  double commanded_ = 0;  ///< s: when the newest command was computed
  double heard_, sent_;   ///< s: last sample that could arrive, last message that got through to the device
  bool pushing_ = false;  ///< that message was a force other than zero
  Sample sample_;
  std::atomic<std::uint32_t> buttons_{0};
  std::atomic<Injected> injected_{Injected::none};
};

}  // namespace palpate::device
