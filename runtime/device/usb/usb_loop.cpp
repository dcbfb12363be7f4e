// SPDX-License-Identifier: MIT
#include "device/usb/usb_loop.hpp"

#include "device/clamp_command.hpp"

#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace palpate::device {

namespace {

constexpr double kSettling = 0.5;  // s that a transfer may take before the device is ready: firmware is written slowly
constexpr double kGone = 1.0;      // s for transfers that were called back to come home
constexpr int kMostErrors = 64;    // transfers of input in a row that fail on the wire

Outcome outcome_of(const libusb_transfer& transfer) {
  switch (transfer.status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return Outcome::done;
    case LIBUSB_TRANSFER_STALL:
      return Outcome::stalled;
    case LIBUSB_TRANSFER_NO_DEVICE:
      return Outcome::gone;
    default:
      return Outcome::timed_out;
  }
}

}  // namespace

UsbLoop::UsbLoop(std::unique_ptr<UsbLink> link, std::unique_ptr<Protocol> protocol, const DeviceKind& kind,
                 const UsbOptions& options)
    : link_(std::move(link)),
      protocol_(std::move(protocol)),
      kind_(kind),
      options_(options),
      period_(1 / options.rate) {}

UsbLoop::~UsbLoop() {
  stop();
  // Closed first: what the kernel still had of a transfer is its own from now on.
  link_->close();
  for (libusb_transfer* transfer : inputs_) libusb_free_transfer(transfer);
  libusb_free_transfer(output_);
  libusb_free_transfer(zero_);
  if (timer_ >= 0) ::close(timer_);
  if (wake_ >= 0) ::close(wake_);
}

bool UsbLoop::start(std::string& error) {
  timer_ = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
  wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (timer_ < 0 || wake_ < 0) {
    error = std::string("the device's thread has no timer: ") + std::strerror(errno);
    return false;
  }
  const auto count = static_cast<std::size_t>(options_.inputs), size = static_cast<std::size_t>(link_->input_size);
  input_bytes_.resize(count * size);
  for (std::size_t k = 0; k < count; ++k) inputs_.push_back(libusb_alloc_transfer(0));
  output_ = libusb_alloc_transfer(0);
  zero_ = libusb_alloc_transfer(0);
  const libusb_pollfd** descriptors = libusb_get_pollfds(link_->context);
  if (output_ == nullptr || zero_ == nullptr || descriptors == nullptr ||
      std::count(inputs_.begin(), inputs_.end(), nullptr) > 0) {
    error = "libusb has no memory for transfers";
    return false;
  }
  for (const libusb_pollfd** each = descriptors; *each != nullptr; ++each) {
    events_.push_back({(*each)->fd, (*each)->events, 0});
  }
  libusb_free_pollfds(descriptors);
  events_.push_back({timer_, POLLIN, 0});
  events_.push_back({wake_, POLLIN, 0});
  thread_ = std::thread([this] { run(); });
  return true;
}

void UsbLoop::stop() {
  if (!thread_.joinable()) return;
  stop_ = true;
  const std::uint64_t one = 1;
  // It cannot fill up: this is its only write.
  [[maybe_unused]] const ssize_t written = ::write(wake_, &one, sizeof one);
  thread_.join();
}

UsbCounts UsbLoop::counts() const noexcept {
  constexpr auto any = std::memory_order_relaxed;
  return {periods_.load(any), late_.load(any),      blocked_.load(any), stale_.load(any),
          packets_.load(any), zero_left_.load(any), realtime_.load(any)};
}

bool UsbLoop::ready() const { return protocol_->sample().phase == Phase::ready; }

void UsbLoop::run() {
  if (options_.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = options_.priority;
    realtime_ = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
  }
  begin();
  while (!stop_ && fault_ == Fault::none) {
    wait(wake_time());
    pump();
    step(now());
    if (protocol_->sample().phase == Phase::stopped) note(protocol_->sample().fault);
    publish();
  }
  let_go();
  publish();
  call_back();
  while (!stop_) {
    pollfd wake{wake_, POLLIN, 0};
    poll(&wake, 1, -1);
  }
  published_.phase = Phase::closed;
  samples.write(published_);
}

double UsbLoop::wake_time() const {
  const bool watched = sending_ && !called_back_;
  const double limit = watched ? sent_ + write_limit() : tick_;
  if (ready()) return std::min(tick_, limit);
  return sending_ ? limit : until_;
}

double UsbLoop::write_limit() const { return ready() ? options_.write_limit : kSettling; }

void UsbLoop::begin() {
  const double time = now();
  until_ = tick_ = time;
  protocol_->start(time);
  const auto kind = link_->interrupt ? LIBUSB_TRANSFER_TYPE_INTERRUPT : LIBUSB_TRANSFER_TYPE_BULK;
  for (std::size_t k = 0; k < inputs_.size(); ++k) {
    libusb_transfer* input = inputs_[k];
    libusb_fill_bulk_transfer(input, link_->handle, link_->in, &input_bytes_[k * link_->input_size], link_->input_size,
                              input_ended, this, 0);
    input->type = kind;
    if (const int code = libusb_submit_transfer(input); code != 0) {
      return note(code == LIBUSB_ERROR_NO_DEVICE ? Fault::unplugged : Fault::stalled);
    }
    ++queued_;
  }
}

void UsbLoop::step(double time) {
  if (sending_ && !called_back_ && time >= sent_ + write_limit()) {
    called_back_ = true;
    libusb_cancel_transfer(output_);
  }
  if (ready()) {
    if (time >= tick_) period(time);
    return;
  }
  tick_ = time + period_;
  if (sending_ || (!again_ && time < until_)) return;
  again_ = false;
  issue(time, protocol_->next(time, Command{time, {}, {}}));
}

void UsbLoop::period(double time) {
  periods_.fetch_add(1, std::memory_order_relaxed);
  tick_ += period_;
  if (tick_ <= time) {
    const double missed = std::floor((time - tick_) / period_) + 1;
    tick_ += missed * period_;
    periods_.fetch_add(static_cast<std::uint64_t>(missed), std::memory_order_relaxed);
    late_.fetch_add(static_cast<std::uint64_t>(missed), std::memory_order_relaxed);
  }
  if (sending_) {
    blocked_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  commands.read(command_);
  if (!fresh(command_, time)) stale_.fetch_add(1, std::memory_order_relaxed);
  issue(time, protocol_->next(time, clamp_command(command_, kind_, time)));
}

void UsbLoop::issue(double time, const Request& request) {
  if (protocol_->sample().phase == Phase::stopped) return;  // let_go() says the last word
  if (request.kind == Request::Kind::none) {
    constexpr double kSoonest = 50e-6;  // s, so that nobody asks in circles
    until_ = std::max(request.until, time + kSoonest);
    return;
  }
  const int code = submit(output_, output_bytes_, request, output_ended);
  if (code == 0) {
    sending_ = true;
    called_back_ = false;
    sent_ = time;
    return;
  }
  const bool gone = code == LIBUSB_ERROR_NO_DEVICE;
  protocol_->ended(time, gone ? Outcome::gone : Outcome::stalled);
  note(gone ? Fault::unplugged : Fault::stalled);
}

int UsbLoop::submit(libusb_transfer* transfer, unsigned char* bytes, const Request& request,
                    libusb_transfer_cb_fn ended) {
  if (request.kind == Request::Kind::control) {
    libusb_fill_control_setup(bytes, request.request_type, request.request, request.value, request.index, 0);
    libusb_fill_control_transfer(transfer, link_->handle, bytes, ended, this, 0);
  } else {
    std::copy_n(request.bytes, request.size, bytes);
    libusb_fill_bulk_transfer(transfer, link_->handle, link_->out, bytes, request.size, ended, this, 0);
    if (link_->interrupt) transfer->type = LIBUSB_TRANSFER_TYPE_INTERRUPT;
  }
  return libusb_submit_transfer(transfer);
}

void LIBUSB_CALL UsbLoop::input_ended(libusb_transfer* transfer) {
  UsbLoop& self = *static_cast<UsbLoop*>(transfer->user_data);
  --self.queued_;
  switch (transfer->status) {
    case LIBUSB_TRANSFER_COMPLETED:
      self.errors_ = 0;
      self.packets_.fetch_add(1, std::memory_order_relaxed);
      self.protocol_->received(now(), transfer->buffer, static_cast<std::size_t>(transfer->actual_length));
      self.again_ = true;
      break;
    case LIBUSB_TRANSFER_STALL:
      return self.note(Fault::stalled);
    case LIBUSB_TRANSFER_NO_DEVICE:
      return self.note(Fault::unplugged);
    case LIBUSB_TRANSFER_OVERFLOW:
      return self.note(Fault::garbled);  // more than a packet: whose bytes are these?
    case LIBUSB_TRANSFER_CANCELLED:
      return;
    default:
      // The wire's own errors, which also come first when a device is being pulled out.
      if (++self.errors_ > kMostErrors) return self.note(Fault::stalled);
      break;
  }
  if (self.ending_) return;
  if (const int code = libusb_submit_transfer(transfer); code == 0) {
    ++self.queued_;
  } else {
    self.note(code == LIBUSB_ERROR_NO_DEVICE ? Fault::unplugged : Fault::stalled);
  }
}

void LIBUSB_CALL UsbLoop::output_ended(libusb_transfer* transfer) {
  UsbLoop& self = *static_cast<UsbLoop*>(transfer->user_data);
  self.sending_ = false;
  self.again_ = true;
  const Outcome outcome = outcome_of(*transfer);
  self.protocol_->ended(now(), outcome);
  if (outcome == Outcome::gone) self.note(Fault::unplugged);
  // An unsupported control request stalls harmlessly; an endpoint stays halted.
  if (outcome == Outcome::stalled && transfer->type != LIBUSB_TRANSFER_TYPE_CONTROL) {
    self.halted_ = true;
    self.note(Fault::stalled);
  }
}

void LIBUSB_CALL UsbLoop::zero_ended(libusb_transfer* transfer) {
  UsbLoop& self = *static_cast<UsbLoop*>(transfer->user_data);
  self.zeroing_ = false;
  self.zero_outcome_ = outcome_of(*transfer);
}

void UsbLoop::wait(double time) {
  itimerspec when{};
  const double seconds = std::floor(std::max(time, 1e-9));
  when.it_value.tv_sec = static_cast<time_t>(seconds);
  when.it_value.tv_nsec = std::min(static_cast<long>((std::max(time, 1e-9) - seconds) * 1e9) + 1, 999999999L);
  timerfd_settime(timer_, TFD_TIMER_ABSTIME, &when, nullptr);
  poll(events_.data(), events_.size(), -1);
}

void UsbLoop::pump() {
  timeval none{};
  libusb_handle_events_timeout_completed(link_->context, &none, nullptr);
}

template <class Done>
void UsbLoop::pump_until(double time, Done done) {
  pump();
  while (!done() && now() < time) {
    // stop() may have rung already: its descriptor is left out, or this would not wait at all.
    events_.back().fd = -1;
    wait(time);
    pump();
  }
}

void UsbLoop::let_go() {
  const double end = now() + kLetGo;
  if (fault_ == Fault::unplugged) return;
  if (sending_) {
    // A healthy command leaves by itself; what is stuck must not leave after the zero.
    if (fault_ == Fault::none) pump_until(std::min(end, now() + kLetGo / 4), [&] { return !sending_; });
    if (sending_) libusb_cancel_transfer(output_);
    pump_until(end, [&] { return !sending_; });
  }
  const Request zero = protocol_->zero();
  while (zero.kind != Request::Kind::none) {
    if (halted_) libusb_clear_halt(link_->handle, link_->out);
    const int code = submit(zero_, zero_bytes_, zero, zero_ended);
    zeroing_ = code == 0;
    if (code == LIBUSB_ERROR_NO_DEVICE) break;
    pump_until(end, [&] { return !zeroing_; });
    if (code == 0 && !zeroing_ && zero_outcome_ == Outcome::done) {
      zero_left_ = true;
      break;
    }
    if (zeroing_ || zero_outcome_ == Outcome::gone || now() >= end) break;
    halted_ = zero_outcome_ == Outcome::stalled;
    constexpr double kPause = 0.001;  // s
    pump_until(std::min(end, now() + kPause), [] { return false; });
  }
}

void UsbLoop::call_back() {
  ending_ = true;
  for (libusb_transfer* input : inputs_) libusb_cancel_transfer(input);
  if (sending_) libusb_cancel_transfer(output_);
  if (zeroing_) libusb_cancel_transfer(zero_);
  pump_until(now() + kGone, [&] { return queued_ == 0 && !sending_ && !zeroing_; });
}

void UsbLoop::note(Fault fault) {
  if (fault_ == Fault::none) fault_ = fault;
}

void UsbLoop::publish() {
  Sample sample = protocol_->sample();
  if (fault_ != Fault::none) {
    sample.phase = Phase::stopped;
    sample.fault = fault_;
  }
  if (sample.number == published_.number && sample.phase == published_.phase && sample.fault == published_.fault)
    return;
  published_ = sample;
  samples.write(sample);
}

}  // namespace palpate::device
