// SPDX-License-Identifier: MIT
#include "device/loop/loop.hpp"

#include <cmath>
#include <future>

namespace palpate::device {

const char* LoopOptions::validate() const {
  if (const char* wrong = safety.validate()) return wrong;
  if (const char* wrong = realtime.validate()) return wrong;
  return seconds >= 0 && seconds < 1e6 ? nullptr : "the length of the run is outside 0 to 1e6 s";
}

ForceLoop::ForceLoop(Device& device, ForceSource& source, const LoopOptions& options, StopFlags& stop, TickSink* record,
                     Clock& clock)
    : device_(device),
      source_(source),
      options_(options),
      stop_(stop),
      record_(record),
      clock_(clock),
      controller_(options.safety),
      period_(1 / options.safety.rate) {}

ForceLoop::~ForceLoop() {
  if (thread_.joinable()) {
    if (running()) stop_.emergency_stop();
    thread_.join();
  }
}

Realtime ForceLoop::start() {
  std::promise<Realtime> promise;
  std::future<Realtime> granted = promise.get_future();
  running_.store(true, std::memory_order_release);
  thread_ = std::thread([this, granting = std::move(promise)]() mutable {
    granting.set_value(make_realtime(options_.realtime));
    run();
  });
  return granted.get();
}

void ForceLoop::run() noexcept {
  running_.store(true, std::memory_order_release);
  const double begin = clock_.now();
  double before = begin - period_;
  std::uint64_t index = 0;  // of the period: ticks that are left out count, so that lateness does not add up
  std::uint32_t missed = 0;
  TickOutput out;
  for (std::uint32_t number = 1; out.mode != Mode::stopped; ++number) {
    TickInput seen;
    seen.number = number;
    seen.missed = missed;
    seen.due = begin + static_cast<double>(index) * period_;
    clock_.sleep_until(seen.due);
    seen.sample = device_.read();
    seen.time = clock_.now();
    seen.seconds = seen.time - before;
    before = seen.time;
    seen.requests = stop_.requests();
    if (options_.seconds > 0 && seen.time - begin >= options_.seconds) seen.requests |= TickInput::stop;

    out = controller_.step(seen, source_);
    device_.write(out.command);
    const double done = clock_.now();
    if (record_ != nullptr) record_->put(seen, out);

    missed = static_cast<std::uint32_t>(std::fmin(1e6, std::fmax(0, std::floor((done - seen.due) / period_))));
    index += 1 + missed;
    account(seen, out, missed, done - begin);
    if (number % kPublish == 1 || out.mode == Mode::stopped) latest_.write(counted_);
  }
  running_.store(false, std::memory_order_release);
}

void ForceLoop::account(const TickInput& seen, const TickOutput& out, std::uint32_t missed, double elapsed) noexcept {
  LoopReport& c = counted_;
  const bool gave = c.out.mode == Mode::ramping || c.out.mode == Mode::engaged;
  const bool gives = out.mode == Mode::ramping || out.mode == Mode::engaged || out.mode == Mode::stopping;
  if (gave && !gives && out.cause != Cause::asked) ++c.suspensions;
  if (c.ticks > 0) c.period.add(seen.seconds);
  ++c.ticks;
  c.elapsed = elapsed;
  c.missed += missed;
  c.late_ticks += seen.seconds > options_.safety.gap ? 1 : 0;
  c.stale_ticks += out.cause == Cause::stale ? 1 : 0;
  c.late.add(seen.time - seen.due);
  if (seen.sample.phase == Phase::ready) c.age.add(seen.time - seen.sample.time);
  c.peak_force = std::fmax(c.peak_force, out.command.strength());
  c.seen = seen;
  c.out = out;
}

void ForceLoop::join() {
  if (thread_.joinable()) thread_.join();
}

const LoopReport& ForceLoop::report() {
  latest_.read(reported_);
  return reported_;
}

}  // namespace palpate::device
