// SPDX-License-Identifier: GPL-3.0-or-later
// A force loop in a child process whose last command outlives it, in memory that parent and child share.
#pragma once

#include "tests/device/loop/scripted_device.hpp"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace palpate::test {

struct Shared {
  std::atomic<int> commands{0};
  std::atomic<double> force{0}, last{0};  ///< N, of the newest command; s, when it was computed
  std::atomic<bool> pushed{false};        ///< some command had a force
};

class SharedMemory {
public:
  SharedMemory()
      : shared_(new (::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))
                    Shared()) {}
  ~SharedMemory() { ::munmap(shared_, sizeof(Shared)); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  Shared* operator->() { return shared_; }
  Shared& operator*() { return *shared_; }

private:
  Shared* shared_;
};

/// Ready at once; its wire is the shared memory.
class SharedDevice : public device::Device {
public:
  explicit SharedDevice(Shared& shared) : shared_(shared) {}
  [[nodiscard]] const device::DeviceKind& kind() const override { return kind_; }
  Sample read() noexcept override {
    Sample sample;
    sample.time = device::now();
    sample.number = static_cast<std::uint32_t>(shared_.commands) + 1;
    sample.phase = Phase::ready;
    return sample;
  }
  void write(const Command& command) noexcept override {
    shared_.force = length(command.force);
    shared_.last = command.time;
    if (length(command.force) > 0) shared_.pushed = true;
    ++shared_.commands;
  }
  void close() override {}

private:
  device::DeviceKind kind_{"shared", 0, 0, 5, 1000, 0.1, 0.5};
  Shared& shared_;
};

inline device::LoopOptions short_ramp() {
  device::LoopOptions options;
  options.safety.ramp_up = 0.01;
  options.safety.missed_share = 1;  // a machine that does much else
  options.safety.silent = 10;
  options.realtime.lock_memory = false;
  return options;
}

inline void wait_for(const std::atomic<bool>& flag) {
  for (int k = 0; k < 20000 && !flag; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace palpate::test
