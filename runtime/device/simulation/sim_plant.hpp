// SPDX-License-Identifier: MIT
// A haptic device in a hand, as differential equations: what a force loop closes over when no device is plugged in.
#pragma once

#include "palpate/math/pose.hpp"

#include <array>
#include <functional>
#include <optional>
#include <string>

namespace palpate::device {

using runtime::Vec3;

/// The position that the hand aims at.
struct Intent {
  Vec3 position;  ///< m, device's frame
  Vec3 velocity;  ///< m/s
};

/// A grip of second order: a mass that moves with the handle, drawn to the intended position by a spring and a damper
/// (the model that Hajian and Howe 1997 identify fingertips with). All three 0: nobody holds the device.
struct Hand {
  double mass = 0.02;      ///< kg, at least 0
  double stiffness = 300;  ///< N/m, at least 0
  double damping = 4;      ///< N s/m, at least 0
  /// Intent at a time (s since the plant began); unset: rest at the origin. Must not allocate: it is called in a tick.
  std::function<Intent(double)> intended;
};

/// A motion that goes out and back along one line, and to both sides of it.
struct Probing {
  Vec3 from;               ///< m
  Vec3 stroke;             ///< m, to the far end and back
  Vec3 sway;               ///< m, amplitude
  double frequency = 0.5;  ///< Hz of the stroke; above 0
  double swaying = 0.2;    ///< Hz of the sway
  Intent operator()(double time) const;
};

/// The plant: M dv/dt = force - b v - friction + spring and damper of the hand, M and b of device and hand together,
/// the same in every direction. Flexible parts, backlash and amplifier dynamics are left out.
struct PlantOptions {
  double mass = 0.1;          ///< kg, apparent at the handle; above 0
  double damping = 0.5;       ///< N s/m, viscous; at least 0
  double friction = 0.1;      ///< N, Coulomb, at rest as in motion; at least 0
  double resolution = 50e-6;  ///< m, step of the encoders at the handle; 0: none
  double delay_in = 0.0002;   ///< s, from an encoder to the loop; [0, 0.1]
  double delay_out = 0.0002;  ///< s, from the loop to a motor; [0, 0.1]
  double peak_force = 5;      ///< N, longer forces are shortened along their line; above 0
  double substep = 10e-6;     ///< s, longest of the integration; [1e-7, 1e-3]
  Hand hand;
  Vec3 start;  ///< m

  /// The first invalid value, with its range; empty when all are valid.
  [[nodiscard]] std::optional<std::string> validate() const;
};

/// Deterministic: the same calls give the same bits. seen() and command() neither allocate nor throw; their times must
/// not go back (s; the plant begins at 0).
class SimPlant {
public:
  /// Throws std::invalid_argument where the options are not usable.
  explicit SimPlant(const PlantOptions& options);

  /// The position (m) that the loop receives at a time: encoder steps that are delay_in old.
  Vec3 seen(double time);

  /// Motors hold this force (N) from delay_out after `time` until the next. A value that is not finite becomes zero.
  void command(double time, const Vec3& force);

  /// Moves on to a time. seen() does so by itself.
  void advance(double to);

  /// Somebody takes the handle and puts it here (m, m/s), now.
  void place(const Vec3& position, const Vec3& velocity);

  [[nodiscard]] const PlantOptions& options() const { return options_; }
  [[nodiscard]] double time() const { return time_; }        ///< s, how far it has moved on
  [[nodiscard]] Vec3 position() const { return position_; }  ///< m, true
  [[nodiscard]] Vec3 velocity() const { return velocity_; }  ///< m/s, true
  [[nodiscard]] Vec3 force() const { return force_; }        ///< N, of the motors
  [[nodiscard]] double given() const { return given_; }      ///< J, work of the motors on the handle since the start
  /// J that friction and damping of the device (not the hand) have turned into heat since the start.
  [[nodiscard]] double lost() const { return lost_; }

private:
  struct Pending {
    double at = 0;
    Vec3 force;
  };
  void run(double to);

  PlantOptions options_;
  double time_ = 0, given_ = 0, lost_ = 0;
  Vec3 position_, velocity_, force_;
  std::array<Pending, 256> pending_;  ///< a ring, in order of time
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace palpate::device
