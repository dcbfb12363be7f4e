// SPDX-License-Identifier: MIT
// The device's side of the open link (open_link.md) without its hardware: frames in and out, limits, watchdog. Needs a
// C++17 compiler and no library; no heap, no exceptions, no interrupts of its own.
#pragma once

#include "device/open_link/open_link_codec.hpp"

namespace palpate::device::openlink {

/// The hardware's measurements at one moment.
struct Measured {
  float position[3] = {};               ///< m, from the middle of the workspace
  float orientation[4] = {1, 0, 0, 0};  ///< unit quaternion w, x, y, z
  uint32_t buttons = 0;
  bool homed = false;  ///< the position is true
  uint8_t fault = 0;   ///< other than 0: the motors must not be driven
};

/// `Board` is the hardware, five functions:
///
///   uint32_t microseconds();                               a clock that wraps at 2^32
///   void measure(Measured&);                               the newest measurement
///   void actuate(const float* force, const float* torque); three of each, N and N m, to the motors; zero: let go
///   size_t receive(uint8_t* bytes, size_t most);           what has come in, without waiting; how many
///   void send(const uint8_t* bytes, size_t size);          at most 64, without waiting; may lose them, not cut them
///
/// Call step() in a loop, as often as possible: what it does takes a few microseconds.
template <class Board>
class Firmware {
public:
  /// `capabilities` has nothing wrong() with it.
  Firmware(Board& board, const Capabilities& capabilities) : board_(board), capabilities_(capabilities) {}

  void step() {
    Measured measured;
    board_.measure(measured);
    clock_ = board_.microseconds();
    uint8_t bytes[kMostFrame];
    const size_t count = board_.receive(bytes, sizeof bytes);
    for (size_t i = 0; i < count; ++i) {
      reader_.put(bytes[i]);
      for (Frame frame; reader_.get(frame);) take(frame, measured);
    }
    if (drive_.on && clock_ - driven_ > watchdog()) {
      let_go();
      tripped_ = true;
    }
    if (!measured.homed || measured.fault != 0) let_go();
    // Each time anew: what a force is for the motors changes with the pose.
    board_.actuate(drive_.force, drive_.torque);
  }

private:
  [[nodiscard]] uint32_t watchdog() const { return static_cast<uint32_t>(1e6F * capabilities_.watchdog); }

  void let_go() { drive_ = {}; }

  void take(const Frame& frame, const Measured& measured) {
    Hello hello;
    Drive drive;
    if (decode(frame, hello)) {
      let_go();
      tripped_ = false;
      spoken_ = hello.major == kMajor;
      heard_ = frame.sequence();
      send(encode(sequence_, capabilities_));
    } else if (spoken_ && decode(frame, drive)) {
      const bool fresh = newer(frame.sequence(), heard_);
      if (drive.on && !fresh) return;
      if (fresh) heard_ = frame.sequence();
      if (drive.on) {
        obey(drive, measured);
      } else {
        let_go();
      }
      answer(measured);
    }
  }

  void obey(Drive& drive, const Measured& measured) {
    const bool whole = limit(drive.force, capabilities_.peak_force, capabilities_.drives) &&
                       limit(drive.torque, capabilities_.peak_torque, capabilities_.drives >> 3);
    if (!whole || tripped_ || !measured.homed || measured.fault != 0) return let_go();
    drive_ = drive;
    driven_ = clock_;
  }

  /// Leaves out what is not driven and shortens what is too long; false: a number is none.
  static bool limit(float (&vector)[3], float most, unsigned axes) {
    float largest = 0;
    for (unsigned i = 0; i < 3; ++i) {
      const float size = vector[i] < 0 ? -vector[i] : vector[i];
      if (!(size <= 3.4028235e38F)) return false;
      if ((axes >> i & 1U) == 0) {
        vector[i] = 0;
      } else if (size > largest) {
        largest = size;
      }
    }
    if (largest == 0) return true;
    // In parts of the largest: the square of a huge number is none.
    float squared = 0;
    for (const float part : vector) squared += (part / largest) * (part / largest);
    const float longer = __builtin_sqrtf(squared);  // 1 to 1.74
    if (largest <= most / longer) return true;
    for (float& part : vector) part = (part / largest) * (most / longer);
    return true;
  }

  void answer(const Measured& measured) {
    State state;
    state.clock = clock_;
    state.flags = static_cast<uint8_t>((measured.homed ? State::kHomed : 0) | (drive_.on ? State::kDriving : 0) |
                                       (tripped_ ? State::kTripped : 0));
    state.fault = measured.fault;
    state.heard = heard_;
    state.buttons = measured.buttons;
    for (size_t i = 0; i < 3; ++i) state.position[i] = measured.position[i];
    for (size_t i = 0; i < 4; ++i) state.orientation[i] = measured.orientation[i];
    send(encode(sequence_, state));
  }

  void send(const Frame& frame) {
    board_.send(frame.bytes, frame.size());
    ++sequence_;
  }

  Board& board_;
  Capabilities capabilities_;
  Reader reader_;
  Drive drive_;
  uint32_t clock_ = 0, driven_ = 0;  // us
  uint8_t sequence_ = 0, heard_ = 0;
  bool spoken_ = false, tripped_ = false;
};

}  // namespace palpate::device::openlink
