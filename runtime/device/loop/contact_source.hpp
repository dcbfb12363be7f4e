// SPDX-License-Identifier: MIT
// Forces of a baked body on a device that holds one of its tools.
#pragma once

#include "device/loop/scene_answer.hpp"
#include "palpate/contact/contact_set.hpp"
#include "palpate/output/device_frame.hpp"
#include "palpate/output/output_chain.hpp"
#include "palpate/output/virtual_coupling.hpp"

namespace palpate::device {

/// Scene force through the frame and the output's steps. The view must outlive it.
/// Tie: what the device holds the tool by, runtime::Rigid or runtime::VirtualCoupling. Contact: runtime::Contact, or
/// runtime::ContactSet for a tool that is felt at several places.
template <class Tie = runtime::Rigid, class Contact = runtime::Contact, class... Steps>
class ContactSource : public ForceSource {
public:
  ContactSource(const runtime::View& view, std::uint32_t tool, const runtime::DeviceFrame& frame, const Tie& tie = {},
                const runtime::OutputChain<Steps...>& output = {})
      : contact_(view, tool), frame_(frame), tie_(tie), output_(output) {}

  Answer answer(const Sample& sample, double seconds) noexcept override {
    device_ = frame_.to_scene(sample.pose);
    tick_ = tie_.tick(contact_, device_, seconds);
    Answer answer = scene_answer(frame_, tick_);
    if (answer.usable) answer.force = output_(answer.force, seconds);
    return answer;
  }

  void reset() noexcept override {
    contact_.reset();
    tie_.reset();
    output_.reset();
    tick_ = {};
  }

  /// The tick of the last answer, in the scene.
  [[nodiscard]] const runtime::Tick& tick() const { return tick_; }
  [[nodiscard]] Pose tool() const { return held(tie_, device_); }
  [[nodiscard]] const Contact& contact() const { return contact_; }

private:
  static Pose held(const runtime::Rigid&, const Pose& device) { return device; }
  static Pose held(const runtime::VirtualCoupling& tie, Pose device) {
    device.translation = tie.tool();
    return device;
  }

  Contact contact_;
  runtime::DeviceFrame frame_;
  Tie tie_;
  runtime::OutputChain<Steps...> output_;
  Pose device_;
  runtime::Tick tick_;
};

using CoupledSource = ContactSource<runtime::VirtualCoupling>;

/// The coupling that is `hand` (N/m, N s/m) in the hand, for a frame whose force_scale is above 0.
inline runtime::VirtualCoupling coupling_in(const runtime::DeviceFrame& frame, runtime::CouplingOptions hand) {
  const double share = 1 / (frame.scale * frame.force_scale);
  hand.stiffness *= share;
  hand.damping *= share;
  return runtime::VirtualCoupling(hand);
}

}  // namespace palpate::device
