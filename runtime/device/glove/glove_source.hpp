// SPDX-License-Identifier: MIT
// Forces of a baked body on a glove whose cables pull the fingers open: five fingertips, each with its own contact.
#pragma once

#include "device/glove/glove_options.hpp"
#include "device/glove/hand_calibration.hpp"
#include "device/loop/force_source.hpp"
#include "palpate/output/device_frame.hpp"
#include "palpate/output/output_chain.hpp"
#include "palpate/shared/tool_set.hpp"

#include <algorithm>
#include <utility>

namespace palpate::device {

/// One sphere tool of the file at five fingertips. A force of the scene is projected on the one direction in which its
/// finger's cable pulls (across the last bone, so that the hand opens), then limited, smoothed and limited in its rate
/// there: it never pushes, and a finger that turns does not turn what is remembered. Tangential parts and torques are
/// lost. A sample's pose is the hand's frame in the device's. The answer's depth is the deepest finger's; after one
/// that is not usable what overlaps begins without force.
class GloveSource : public ForceSource {
public:
  /// The view must outlive it.
  GloveSource(const runtime::View& view, std::uint32_t tool, HandCalibration calibration,
              const runtime::DeviceFrame& frame = {}, const GloveOptions& options = {})
      : calibration_(std::move(calibration)), frame_(frame), tools_(view, {tool, tool, tool, tool, tool}) {
    if (!calibration_.usable()) {
      problem_ = calibration_.problem.c_str();
    } else if (tool >= view.meta->tool_count ||
               view.tools[tool].kind != static_cast<std::uint32_t>(layout::ToolKind::point_sphere)) {
      problem_ = "the tool is no sphere";
    } else if (!options.valid()) {
      problem_ = "the glove's limit, rate or frequency is out of range";
    }
    cables_.fill(Cable({{0, 0, 1}, true}, {options.limit}, {options.frequency}, {options.rate}));
  }
  GloveSource(const GloveSource&) = delete;
  GloveSource& operator=(const GloveSource&) = delete;

  /// Why no answer will ever be usable; null where they may be.
  [[nodiscard]] const char* problem() const { return problem_; }

  Answer answer(const Sample& sample, double seconds) noexcept override {
    if (problem_ || !(seconds > 0 && std::isfinite(seconds))) return none();
    Answer answer;
    const HandJoints angles = calibration_.angles(sample.joints);
    std::array<Pose, kFingers> tips, scene;
    for (std::size_t f = 0; f < kFingers; ++f) {
      for (const double angle : angles[f]) {
        if (!(std::fabs(angle) < kBeyond)) return none();
      }
      tips[f] = sample.pose * calibration_.hand[f].tip(angles[f]);
      scene[f] = frame_.to_scene(tips[f]);
    }
    ticks_ = tools_.tick(scene);
    for (const runtime::Tick& tick : ticks_) {
      if (tick.state == runtime::State::fault) return none();
    }
    for (std::size_t f = 0; f < kFingers; ++f) {
      const Vec3 at_tip = inverse(tips[f]).rotate(frame_.to_device(ticks_[f].force));
      answer.pull[f] = cables_[f](at_tip, seconds).z;
      answer.depth = std::max(answer.depth, ticks_[f].depth);
    }
    answer.usable = true;
    return answer;
  }

  void reset() noexcept override {
    tools_.reset();
    for (Cable& cable : cables_) cable.reset();
    ticks_ = {};
  }

  /// The fingers' ticks of the last answer, in the scene.
  [[nodiscard]] const std::array<runtime::Tick, kFingers>& ticks() const { return ticks_; }
  /// Error of adding the fingertips' forces where they are near each other.
  [[nodiscard]] const runtime::SuperpositionError& superposition() const { return tools_.superposition(); }

private:
  using Cable = runtime::OutputChain<runtime::output::OneAxis, runtime::output::Limit, runtime::output::LowPass,
                                runtime::output::RateLimit>;
  static constexpr double kBeyond = 3.2;  // rad: no joint bends so far, the sensor is broken

  Answer none() noexcept {
    reset();
    return {};
  }

  HandCalibration calibration_;
  runtime::DeviceFrame frame_;
  runtime::ToolSet<static_cast<int>(kFingers)> tools_;
  std::array<Cable, kFingers> cables_;
  std::array<runtime::Tick, kFingers> ticks_;
  const char* problem_ = nullptr;
};

}  // namespace palpate::device
