// SPDX-License-Identifier: MIT
#include "device/falcon/falcon_boot.hpp"

#include "device/usb/ftdi.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <utility>

namespace palpate::device::falcon {
namespace {

using ftdi::Setting;

// The settings that each step applies before it sends bytes.
constexpr Setting kForFirmware[] = {ftdi::latency(1), ftdi::kNoFlowControl, ftdi::k8N1,
                                    ftdi::kBaud1500k, ftdi::kPurgeInput,    ftdi::kPurgeOutput};
constexpr Setting kForLoader[] = {ftdi::kPurgeInput, ftdi::kPurgeOutput, ftdi::latency(16),
                                  ftdi::kBaud9600,   ftdi::k8N1,         ftdi::kNoFlowControl,
                                  ftdi::kRtsLow,     ftdi::kDtrLow,      ftdi::kDtrHigh};
constexpr Setting kForLetter[] = {ftdi::kDtrLow, ftdi::kBaud143k};

struct Table {
  const Setting* settings;
  std::size_t size;
};
template <std::size_t n>
constexpr Table table(const Setting (&settings)[n]) {
  return {settings, n};
}

constexpr std::array<std::uint8_t, 3> kGreeting = {0x0a, 0x43, 0x0d};
constexpr std::array<std::uint8_t, 4> kAnswer = {0x0a, 0x44, 0x2c, 0x0d};
constexpr std::uint8_t kLetter = 0x41;

Request write(const std::uint8_t* bytes, std::size_t size) {
  Request request;
  request.kind = Request::Kind::write;
  std::copy_n(bytes, size, request.bytes);
  request.size = static_cast<std::uint8_t>(size);
  return request;
}

}  // namespace

Firmware read_firmware(const std::string& path) {
  Firmware firmware;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) {
    firmware.error = path + ": cannot be opened";
    return firmware;
  }
  firmware.bytes.resize(kMostFirmware + 1);
  firmware.bytes.resize(std::fread(firmware.bytes.data(), 1, firmware.bytes.size(), file.get()));
  if (std::ferror(file.get()) != 0) {
    firmware.error = path + ": cannot be read";
  } else if (firmware.bytes.empty()) {
    firmware.error = path + ": is empty";
  } else if (firmware.bytes.size() > kMostFirmware) {
    firmware.error = path + ": is longer than any firmware of a Falcon (" + std::to_string(kMostFirmware) + " bytes)";
  }
  if (!firmware.error.empty()) firmware.bytes.clear();
  return firmware;
}

void Boot::start(const std::vector<std::uint8_t>& firmware) {
  *this = {};
  firmware_ = &firmware;
  enter(Step::set_up_probe);
}

// A request still in flight belongs to the previous step, because its answer may arrive before its completion is
// reported.
void Boot::enter(Step step) {
  step_ = step;
  outdated_ = in_flight_;
  setting_ = sent_ = echoed_ = matched_ = heard_ = 0;
  tries_ = 0;
  waiting_ = false;
  reader_ = {};
}

void Boot::fail(Fault fault) {
  state_ = State::failed;
  fault_ = fault;
}

// Loads (again), as often as it is worth it.
void Boot::retry() {
  if (firmware_->empty() || attempts_++ == kAttempts) {
    fail(Fault::firmware);
  } else {
    enter(Step::set_up_greeting);
  }
}

bool Boot::talks() const {
  return step_ == Step::probe || step_ == Step::greet || step_ == Step::letter || step_ == Step::load;
}

Request Boot::message() const {
  switch (step_) {
    case Step::greet:
      return write(kGreeting.data(), kGreeting.size());
    case Step::letter:
      return write(&kLetter, 1);
    case Step::load:
      return write(firmware_->data() + sent_, std::min(kChunk, firmware_->size() - sent_));
    default:
      const auto zero = encode(Output{});
      return write(zero.data(), zero.size());
  }
}

Request Boot::next(double time) {
  if (waiting_ && time >= wait_until_) out_of_time();
  Request request;
  if (state_ != State::going) return request;
  if (waiting_) {
    request.until = wait_until_;
    return request;
  }
  in_flight_ = true;
  if (talks()) return message();
  const Table settings = step_ == Step::set_up_probe      ? table(kForFirmware)
                         : step_ == Step::set_up_greeting ? table(kForLoader)
                                                          : table(kForLetter);
  return ftdi::control(settings.settings[setting_]);
}

void Boot::ended(double time, Outcome outcome) {
  in_flight_ = false;
  if (std::exchange(outdated_, false) || state_ != State::going) return;
  if (outcome == Outcome::gone) return fail(Fault::unplugged);
  if (outcome == Outcome::stalled) return fail(Fault::stalled);
  if (outcome == Outcome::timed_out) return fail(Fault::silent);
  switch (step_) {
    case Step::set_up_probe:
      if (++setting_ == std::size(kForFirmware)) enter(Step::probe);
      return;
    case Step::set_up_greeting:
      if (++setting_ == std::size(kForLoader)) enter(Step::greet);
      return;
    case Step::set_up_letter:
      if (++setting_ == std::size(kForLetter)) enter(Step::letter);
      return;
    case Step::load:
      sent_ += std::min(kChunk, firmware_->size() - sent_);
      waiting_ = echoed_ < sent_;
      wait_until_ = time + kEchoWait;
      return;
    case Step::probe:
    case Step::greet:
    case Step::letter:
      waiting_ = true;
      wait_until_ = time + (step_ == Step::probe ? kProbeWait : step_ == Step::greet ? kGreetingWait : kEchoWait);
      return;
  }
}

// Nothing came, or not enough.
void Boot::out_of_time() {
  waiting_ = false;
  ++tries_;
  if (step_ == Step::probe) {
    if (tries_ == kProbes) retry();
  } else if (step_ == Step::greet) {
    if (tries_ == kGreetings) fail(heard_ == 0 ? Fault::silent : Fault::garbled);
  } else {
    retry();
  }
}

void Boot::received(const std::uint8_t* payload, std::size_t size) {
  for (std::size_t i = 0; i < size && state_ == State::going; ++i) heard(payload[i]);
}

void Boot::heard(std::uint8_t byte) {
  switch (step_) {
    case Step::probe:
      if (reader_.take(byte)) state_ = State::running;
      return;
    case Step::greet:
      // Anywhere in the stream: one platform shows a zero in front. Its first byte is found nowhere else in it.
      ++heard_;
      matched_ = byte == kAnswer[matched_] ? matched_ + 1 : (byte == kAnswer[0] ? 1 : 0);
      if (matched_ == kAnswer.size()) enter(Step::set_up_letter);
      return;
    case Step::letter:
      if (!waiting_ && !in_flight_) return;
      return byte == kLetter ? enter(Step::load) : retry();
    case Step::load:
      if (!waiting_ && !in_flight_) return;
      if (echoed_ == firmware_->size() || byte != (*firmware_)[echoed_]) return retry();
      ++echoed_;
      if (echoed_ == firmware_->size()) return enter(Step::set_up_probe);
      if (echoed_ == sent_) waiting_ = false;
      return;
    default:
      return;  // left over from before
  }
}

}  // namespace palpate::device::falcon
