// SPDX-License-Identifier: MIT
// From a Falcon that has just been opened to one whose firmware answers. The maker's firmware is not ours to ship: it
// comes from a file that the user names.
#pragma once

#include "device/falcon/falcon_codec.hpp"
#include "device/usb/protocol.hpp"

#include <string>
#include <vector>

namespace palpate::device::falcon {

/// A firmware file, or why there is none.
struct Firmware {
  std::vector<std::uint8_t> bytes;
  std::string error;  ///< empty: bytes hold the file
};

inline constexpr std::size_t kMostFirmware = 1 << 18;  ///< bytes; what is known of it has a few tens of thousands

Firmware read_firmware(const std::string& path);

/// The boot as a state machine, one request after the other. It first checks whether firmware runs already (with motors
/// at zero: a program that died may have left a force), else loads it, several times if need be: users report that it
/// often takes more than one.
class Boot {
public:
  static constexpr int kProbes = 5, kGreetings = 100, kAttempts = 5;
  static constexpr std::size_t kChunk = 62;                                           ///< bytes of firmware a write
  static constexpr double kProbeWait = 0.05, kGreetingWait = 0.05, kEchoWait = 0.25;  ///< s

  enum class State : std::uint8_t { going, running, failed };

  /// `firmware` outlives this; empty: what does not run already is a fault.
  void start(const std::vector<std::uint8_t>& firmware);

  Request next(double time);
  void ended(double time, Outcome outcome);
  void received(const std::uint8_t* payload, std::size_t size);  ///< without FTDI's status

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] Fault fault() const { return fault_; }

private:
  enum class Step : std::uint8_t { set_up_probe, probe, set_up_greeting, greet, set_up_letter, letter, load };

  void enter(Step step);
  void fail(Fault fault);
  void retry();
  [[nodiscard]] bool talks() const;
  void heard(std::uint8_t byte);
  void out_of_time();
  [[nodiscard]] Request message() const;

  const std::vector<std::uint8_t>* firmware_ = nullptr;
  Reader reader_;
  double wait_until_ = 0;
  std::size_t setting_ = 0;              // of the table of this step
  std::size_t sent_ = 0, echoed_ = 0;    // bytes of firmware
  std::size_t matched_ = 0, heard_ = 0;  // bytes of the greeting's answer; any bytes since greeting began
  int tries_ = 0, attempts_ = 0;
  Step step_ = Step::set_up_probe;
  State state_ = State::going;
  Fault fault_ = Fault::none;
  bool waiting_ = false;                       // for an answer
  bool in_flight_ = false, outdated_ = false;  // a request; one of a step that is over
};

}  // namespace palpate::device::falcon
