// SPDX-License-Identifier: MIT
// The host's side of the open link: see open_link.md.
#pragma once

#include "device/open_link/open_link_codec.hpp"
#include "device/usb/input_watch.hpp"
#include "device/usb/protocol.hpp"

#include <array>

namespace palpate::device {

class OpenLinkProtocol final : public Protocol {
public:
  static constexpr int kHellos = 40;
  static constexpr double kHelloWait = 0.05;      ///< s
  static constexpr double kHomingPeriod = 0.001;  ///< s between frames while it is not homed
  static constexpr int kSteady = 8;               ///< homed samples before it is ready
  static constexpr int kUntaken = 3;              ///< writes that time out one after the other and are a fault
  static constexpr double kFastest = 10;          ///< m/s
  static constexpr double kFastestTurn = 100;     ///< rad/s
  static constexpr InputWatch::Limits kLimits{0.006, 0.100, 256, 16, 3};

  /// Interface and kind of endpoints are the maker's choice.
  explicit OpenLinkProtocol(const Wiring& wiring = {0, 0, 0, false, 64}) : wiring_(wiring) {}

  /// The capabilities that the device announced; valid from the phase of homing on.
  [[nodiscard]] const openlink::Capabilities& capabilities() const { return capabilities_; }

  [[nodiscard]] Wiring wiring() const override { return wiring_; }
  void start(double time) override;
  Request next(double time, const Command& command) override;
  void ended(double time, Outcome outcome) override;
  void received(double time, const std::uint8_t* bytes, std::size_t size) override;
  [[nodiscard]] const Sample& sample() const override { return sample_; }
  [[nodiscard]] Request zero() const override;

private:
  [[nodiscard]] bool going() const { return sample_.phase != Phase::closed && sample_.phase != Phase::stopped; }
  void stop(Fault fault);
  Request hello(double time);
  Request drive(double time, const openlink::Drive& drive);
  [[nodiscard]] openlink::Drive limited(const Command& command) const;
  void take(double time, const openlink::Frame& frame);
  void meet(double time, const openlink::Capabilities& capabilities);
  void take(double time, const openlink::State& state);
  [[nodiscard]] bool possible(double time, const openlink::State& state) const;

  Wiring wiring_;
  openlink::Capabilities capabilities_;
  openlink::Reader reader_;
  InputWatch watch_{kLimits};
  Sample sample_;
  openlink::State last_;                    // the last accepted state
  double last_sent_ = 0;                    // s: when the frame was sent that it answers
  bool any_ = false;                        // there is a last one
  std::array<double, 256> sent_at_{};       // s, by sequence
  std::uint8_t sequence_ = 0, theirs_ = 0;  // last sent, last received
  double ask_at_ = 0;                       // s: nothing is written before
  int hellos_ = 0, steady_ = 0, untaken_ = 0;
  bool noise_ = false;  // instead of an answer to hello
};

}  // namespace palpate::device
