// SPDX-License-Identifier: MIT
// Forces of a baked body whose searches for contact are made by a thread of their own, and what happens when that is
// late.
#pragma once

#include "device/loop/scene_answer.hpp"
#include "palpate/contact/contact.hpp"
#include "palpate/output/device_frame.hpp"
#include "palpate/output/output_chain.hpp"
#include "palpate/threading/triple_buffer.hpp"

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

namespace palpate::device {

struct TrackerOptions {
  double rate = 200;   ///< Hz, above 0, of searches
  double stale = 0.1;  ///< s, above 0: a search of an older pose gives no force
  /// Search function; runtime::search() unless replaced (another collision library, a test). May throw: the tracker
  /// is dead then.
  std::function<runtime::Search(const Pose& scene)> search;
};

/// The force loop calls answer() and reset(); it gives its poses away and takes the newest search, and waits for
/// neither. Before the first search, and while the newest is of a pose older than `stale`, nothing is usable.
class TrackedSource : public ForceSource {
public:
  TrackedSource(const runtime::View& view, std::uint32_t tool, const runtime::DeviceFrame& frame,
                const TrackerOptions& options = {})
      : contact_(view, tool), frame_(frame), stale_(options.stale) {
    thread_ = std::thread([this, &view, tool, options] { track(view, tool, options); });
  }
  ~TrackedSource() override {
    ending_.store(true, std::memory_order_release);
    thread_.join();
  }
  TrackedSource(const TrackedSource&) = delete;
  TrackedSource& operator=(const TrackedSource&) = delete;

  Answer answer(const Sample& sample, double seconds) noexcept override {
    time_ += seconds;
    const Asked asked{time_, frame_.to_scene(sample.pose)};
    asked_.write(asked);
    fresh_ = found_.read(latest_) || fresh_;
    if (!fresh_ || !(time_ - latest_.time <= stale_)) return {};
    return scene_answer(frame_, contact_.tick(asked.pose, latest_.search));
  }

  void reset() noexcept override { contact_.reset(); }

private:
  struct Asked {
    double time = 0;  ///< s of the loop's calls
    Pose pose;
  };
  struct Found {
    double time = 0;  ///< of the pose that was searched for
    runtime::Search search;
  };

  void track(const runtime::View& view, std::uint32_t tool, const TrackerOptions& options) noexcept {
    const auto period = std::chrono::duration<double>(1 / options.rate);
    try {
      while (!ending_.load(std::memory_order_acquire)) {
        Asked asked;
        if (asked_.read(asked) && asked.pose.valid()) {
          found_.write(
              {asked.time, options.search ? options.search(asked.pose) : runtime::search(view, tool, asked.pose)});
        }
        std::this_thread::sleep_for(period);
      }
    } catch (...) {
      // Dead: its searches grow old, and the loop says so.
    }
  }

  runtime::Contact contact_;
  runtime::DeviceFrame frame_;
  double stale_, time_ = 0;
  bool fresh_ = false;  // a search has come
  Found latest_;
  runtime::TripleBuffer<Asked> asked_;
  runtime::TripleBuffer<Found> found_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace palpate::device
