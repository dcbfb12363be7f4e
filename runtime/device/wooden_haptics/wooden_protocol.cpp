// SPDX-License-Identifier: MIT
#include "device/wooden_haptics/wooden_protocol.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace palpate::device {

namespace {

// Jitter of the host (s): two reports may differ by the fastest movement over their interval plus this time.
constexpr double kJitter = 0.005;
// Between two reports of a board that is held still so much (s) counts for it at most: what the host was away for it
// has not seen, and what waited for it meanwhile is of one moment.
constexpr double kWatched = 0.005;

Request report(const std::array<std::int16_t, 3>& milliamps) {
  Request request;
  request.kind = Request::Kind::write;
  std::uint8_t bytes[kWoodenReport];
  encode(milliamps, bytes);
  std::copy(std::begin(bytes), std::end(bytes), request.bytes);
  request.size = kWoodenReport;
  return request;
}

}  // namespace

const char* WoodenOptions::validate() const {
  if (const char* wrong = geometry.validate()) return wrong;
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  for (const double angle : home) {
    if (!std::isfinite(angle)) return "the angles of the home pose are finite";
  }
  if (!positive(hold) || !positive(boot)) return "the times of homing and boot are above 0";
  if (still < 0) return "the counts of stillness are not negative";
  if (!positive(most_current) || most_current > 32.767) return "the largest current is above 0 and at most 32.767 A";
  if (!positive(fastest)) return "the fastest joint speed is above 0";
  if (!(fold >= 0 && fold < kPi)) return "the fold is from 0 to pi";
  if (!positive(doubtful) || !(silence >= doubtful) || !std::isfinite(silence)) {
    return "silence is not shorter than doubt, and both are above 0";
  }
  if (!positive(period)) return "the period is above 0";
  return nullptr;
}

void WoodenProtocol::start(double time) {
  sample_ = {};
  sample_.phase = Phase::starting;
  heard_ = write_ = time;
  still_ = 0;
  asking_ = noise_ = false;
}

Request WoodenProtocol::next(double time, const Command& command) {
  if (sample_.phase == Phase::stopped) return zero();
  const double quiet = time - heard_;
  if (quiet > (sample_.phase == Phase::starting ? options_.boot : options_.silence)) {
    stop(noise_ ? Fault::garbled : Fault::silent);
    return zero();
  }
  if (sample_.phase == Phase::ready) {
    if (asking_ && time - asked_ > options_.silence) {
      stop(Fault::stalled);
      return zero();
    }
    if (quiet > options_.doubtful) return ask(time, {});
    return ask(time, milliamps(currents(options_.geometry, angles_, command.force), options_.most_current));
  }
  if (time < write_) {
    Request none;
    none.until = write_;
    return none;
  }
  write_ = time + options_.period;
  return ask(time, {});
}

Request WoodenProtocol::ask(double time, const std::array<std::int16_t, 3>& milliamps) {
  if (!asking_) asked_ = time;
  asking_ = true;
  return report(milliamps);
}

void WoodenProtocol::ended(double, Outcome outcome) {
  if (outcome == Outcome::done) asking_ = false;
  if (sample_.phase == Phase::stopped) return;
  if (outcome == Outcome::stalled) stop(Fault::stalled);
  if (outcome == Outcome::gone) stop(Fault::unplugged);
}

void WoodenProtocol::received(double time, const std::uint8_t* bytes, std::size_t size) {
  if (sample_.phase == Phase::stopped || sample_.phase == Phase::closed) return;
  WoodenReport report;
  if (sample_.phase == Phase::starting && is_six_joint_report(bytes, size)) return stop(Fault::firmware);
  if (!decode(bytes, size, report)) {
    noise_ = true;
    return;
  }
  const bool first = sample_.phase == Phase::starting;
  if (!first && report.number == last_) return;  // the same again is no news
  if (first) {
    for (int k = 0; k < 3; ++k) encoders_[k].start(report.encoder[k]);
    sample_.phase = Phase::homing;
  } else {
    if (!possible(time, report)) return stop(Fault::impossible);
    for (int k = 0; k < 3; ++k) encoders_[k].follow(report.encoder[k]);
  }
  if (sample_.phase == Phase::homing) home(first ? 0 : time - heard_);
  last_ = report.number;
  heard_ = time;
  noise_ = false;
  if (sample_.phase == Phase::ready) {
    locate();
    const double fold = angles_[1] + angles_[2];
    if (fold < -options_.fold || fold > kPi + options_.fold) return stop(Fault::impossible);
    sample_.pose.translation = position(options_.geometry, angles_);
  }
  sample_.time = time;
  ++sample_.number;
}

bool WoodenProtocol::possible(double time, const WoodenReport& report) const {
  const double fastest = options_.fastest * (time - heard_ + kJitter);
  const Joints most = counts(options_.geometry, {fastest, fastest, fastest});
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(encoders_[k].step(report.encoder[k])) > std::fabs(most[k]) + 1) return false;
  }
  return true;
}

void WoodenProtocol::home(double passed) {
  const bool moved = std::any_of(std::begin(encoders_), std::end(encoders_), [&](const Unwrapped& encoder) {
    return std::llabs(encoder.total()) > options_.still;
  });
  still_ = moved ? 0 : still_ + std::min(passed, kWatched);
  if (moved) {
    for (Unwrapped& encoder : encoders_) encoder.restart();
  }
  if (still_ < options_.hold) return;
  for (Unwrapped& encoder : encoders_) encoder.restart();
  sample_.phase = Phase::ready;
}

void WoodenProtocol::locate() {
  Joints at = counts(options_.geometry, options_.home);
  for (std::size_t k = 0; k < 3; ++k) at[k] += static_cast<double>(encoders_[k].total());
  angles_ = angles(options_.geometry, at);
}

Request WoodenProtocol::zero() const { return report({}); }

void WoodenProtocol::stop(Fault fault) {
  sample_.phase = Phase::stopped;
  sample_.fault = fault;
}

}  // namespace palpate::device
