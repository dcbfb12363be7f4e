// SPDX-License-Identifier: MIT
// Forces of a baked body on a device that holds one of its tools.
#pragma once

#include "device/force_source.hpp"
#include "palpate/contact.hpp"
#include "palpate/output.hpp"

namespace palpate::device {

/// Scene force through the frame and the output's steps. The view must outlive it.
template <class... Steps>
class ContactSource : public ForceSource {
public:
  ContactSource(const runtime::View& view, std::uint32_t tool, const runtime::DeviceFrame& frame,
                const runtime::Output<Steps...>& output = {})
      : contact_(view, tool), frame_(frame), output_(output) {}

  Answer answer(const Pose& pose, double seconds) noexcept override {
    tick_ = contact_.tick(frame_.to_scene(pose));
    Answer answer;
    if (tick_.state == runtime::State::fault) return answer;
    answer.force = output_(frame_.to_device(tick_.force), seconds);
    answer.torque = frame_.to_device(tick_.torque);
    answer.depth = tick_.depth;
    answer.usable = true;
    return answer;
  }

  void reset() noexcept override {
    contact_.reset();
    output_.reset();
    tick_ = {};
  }

  /// In the scene.
  [[nodiscard]] const runtime::Tick& tick() const { return tick_; }

private:
  runtime::Contact contact_;
  runtime::DeviceFrame frame_;
  runtime::Output<Steps...> output_;
  runtime::Tick tick_;
};

}  // namespace palpate::device
