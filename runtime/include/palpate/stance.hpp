// SPDX-License-Identifier: MIT
// How a tool stands in a contact: where on it p is, where p runs as the tool tilts, and how far the tool turned.
#pragma once

#include "palpate/field.hpp"
#include "palpate/patch_run.hpp"
#include "palpate/tool.hpp"

#include <cmath>

namespace palpate::runtime {

/// The point p of a tool that touches, and how the tool lies there, on which its responses depend. n is n(c)
/// throughout. Of layout::Feature those that kFeatures leaves out take neither code nor memory.
template <std::uint32_t kFeatures>
class BasicStance {
  static constexpr bool kSpin = (kFeatures & layout::feature_spin) != 0;

public:
  BasicStance(const View& view, std::uint32_t tool)
      : view_(&view), tool_(tool), probe_(view.tool(tool).probe_radius), run_(view, tool) {
    const layout::ToolRecord& record = view.tool(tool);
    profile_ = record.kind == static_cast<std::uint32_t>(layout::ToolKind::profile) && record.axis_length > 0;
    if constexpr (kSpin) {
      for (std::uint32_t i = 0; view.spins != nullptr && i < record.vertex_count; ++i) {
        spins_ = spins_ || view.spins[record.first_vertex + i] > 1;
      }
      lies_ = spins_;
    }
    lies_ = lies_ || profile_ || run_.runs();
  }

  /// Where a tool's point of a search met the body.
  void begin(const ToolTouch& touch, const Vec3& n, const Pose& pose) {
    point_ = touch.anchor;
    on_tool_ = touch.tool_point;
    if (profile_) {
      along_ = round_ = 0;
      axis_ = pose.rotate(kAxes[0]);
      meridian_ = profile_meridian(view_->tools[tool_], point_.z, pose.along_axis(n));
    }
    run_.begin(pose, {on_tool_, point_});
  }

  [[nodiscard]] const ToolPoint& on_tool() const { return on_tool_; }
  /// m, p in the tool's frame.
  [[nodiscard]] const Vec3& in_tool() const { return point_; }
  /// m, from p to the skin.
  [[nodiscard]] double probe() const { return probe_; }
  /// What answers depends on how the tool lies.
  [[nodiscard]] bool lies() const { return lies_; }
  /// On how it is spun, too: a blend is of up to three times as many responses.
  [[nodiscard]] bool spins() const {
    if constexpr (kSpin) return spins_;
    return false;
  }

  /// However it does, its point of the axis stays: then whatever moves c blends for how it lies now.
  [[nodiscard]] bool lies_in_place(const Pose& pose, const Vec3& n) const {
    return lies_ && !(runs(pose, n) > 1e-9 * probe_);
  }

  /// The tool turned since take_turn() or the last blend.
  [[nodiscard]] bool turned(const Pose& pose) const {
    const Vec3 turned = pose.rotate(normal_in_tool_) - turned_from_;
    return dot(turned, turned) >= 1e-18;
  }
  /// m, that the skin went by that turn, which is noted.
  [[nodiscard]] Vec3 take_turn(const Pose& pose, const Vec3& n) {
    const Vec3 way = probe_ * tangential(pose.rotate(normal_in_tool_) - turned_from_, n);
    note_turn(n, pose);
    return way;
  }

  /// In this tick the tool moved, where p is by `way` (m), in a contact of a `size` (m). So p may run over its profile,
  /// several times as far as the skin went, for a small tilt takes the deepest place of a stem from end to end; a mesh
  /// tool's over its patches. A tool at rest keeps p where it is.
  [[gnu::noinline]] void let_run(const Pose& pose, const Vec3& way, const Vec3& n, double size) {
    if (run_.runs()) run_.tick(*view_, tool_, {on_tool_, point_}, pose, way, n, size);
    if (!profile_) return;
    const Vec3 axis = pose.rotate(kAxes[0]);
    const double turn = length(axis - axis_), skin = length(way) + probe_ * turn;
    axis_ = axis;
    round_ = kRound * skin;
    along_ = kAlong * (skin + view_->tools[tool_].axis_length * turn);
  }

  /// The tool lies otherwise than when its responses were blended, and has moved.
  [[nodiscard]] PALPATE_TICK_INLINE bool lies_otherwise(const Pose& pose, const Vec3& n) const {
    if constexpr (kSpin) {
      if (spins_) {
        if (spun(pose)) return true;
        if (!profile_ && !run_.runs()) return false;
      }
    }
    if (run_.runs()) return runs(pose, n) > 0;
    if (!(along_ > 0)) return false;
    const double cosine = pose.along_axis(n);
    return runs(pose, n) > 1e-9 * probe_ ||
           std::fabs(profile_meridian(view_->tools[tool_], point_.z, cosine) - meridian_) > 1e-6 * probe_;
  }

  /// Where on the tool p is to be in this tick.
  [[nodiscard]] ToolPlace next(const Pose& pose, const Vec3& n) const {
    if (run_.runs()) return run_.next();
    return {on_tool_, {0, 0, profile_ ? along(pose.along_axis(n)) : point_.z}};
  }
  /// Takes a share of the way to there instead; not where that leads round a corner of a mesh tool.
  [[nodiscard]] bool shorten(double share, ToolPlace& there) const {
    if (there.at.patch != on_tool_.patch) return false;
    const double left = 1 - share;
    there.point = left * point_ + share * there.point;
    for (int k = 0; k < 3; ++k) there.at.weights[k] = left * on_tool_.weights[k] + share * there.at.weights[k];
    return true;
  }
  /// p is there from now on.
  void go_to(const ToolPlace& place) {
    point_ = place.point;
    on_tool_ = place.at;
  }

  /// Blends the responses of a point of the body for how the tool lies now.
  void build(const BodyPoint& at, const Vec3& n, const Pose& pose, BasicField<kFeatures>& field) {
    if (profile_) run_round(pose.along_axis(n));
    note_turn(n, pose);
    if constexpr (kSpin) {
      if (spins_) return build_spun(at, n, pose, field);
    }
    field.build(*view_, tool_, at, on_tool_, n);
  }

  /// Turns the tool's pose of the last tick by that of `by`.
  void rebase(const Pose& by) {
    turned_from_ = by.rotate(turned_from_);
    axis_ = by.rotate(axis_);
    run_.rebase(by);
    if constexpr (kSpin) {
      if (spins_) {
        for (Vec3& axis : lay_) axis = by.rotate(axis);
      }
    }
  }

private:
  // What only tools with spins need stays out of line.
  [[gnu::noinline]] void build_spun(const BodyPoint& at, const Vec3& n, const Pose& pose,
                                    BasicField<kFeatures>& field) {
    for (int k = 0; k < 2; ++k) lay_[k] = pose.rotate(kAxes[k]);
    // A tip that lags behind at the pole is turned about it faster than p may run.
    const double lags = profile_ ? kRound * probe_ / std::fmin(meridian_, profile_stem(view_->tools[tool_])) : HUGE_VAL;
    field.build_spun(*view_, tool_, at, on_tool_, n, {&pose, 0, lags});
  }

  /// A turn of a profile about its own axis is none.
  [[nodiscard, gnu::noinline]] bool spun(const Pose& pose) const {
    double turned = 0;
    for (int k = 0; k < (profile_ ? 1 : 2); ++k) {
      const Vec3 way = pose.rotate(kAxes[k]) - lay_[k];
      turned += dot(way, way);
    }
    return turned >= 1e-18;
  }

  /// What the pose makes of n is kept with it: a rotation is taken that is orthonormal to 1e-3 only, and what is
  /// missing must not count as a turn in every tick.
  void note_turn(const Vec3& n, const Pose& pose) {
    normal_in_tool_ = inverse(pose).rotate(n);
    turned_from_ = pose.rotate(normal_in_tool_);
  }

  /// Where on the axis p is to be in this tick (m), for a cosine between n and the axis: as near as it may to where it
  /// is deepest. From the tip it gets there by the end of the axis.
  [[nodiscard]] double along(double cosine) const {
    const layout::ToolRecord& tool = view_->tools[tool_];
    if (!(point_.z > 0) && meridian_ < profile_stem(tool)) return 0;
    constexpr double kBody = 16;  // probe radii, of curvature: a body that is sharper p would cross
    const double step = std::fmax(-along_, std::fmin(along_, -cosine * kBody * probe_));
    return std::fmax(0, std::fmin(tool.axis_length, point_.z + step));
  }

  /// m, that p is to be from where it was.
  [[nodiscard]] double runs(const Pose& pose, const Vec3& n) const {
    if (run_.runs()) return length(run_.next().point - point_);
    return profile_ ? std::fabs(along(pose.along_axis(n)) - point_.z) : 0;
  }

  /// Moves p round the tip to where the skin is parallel to the body, as near as it may: where p comes to the end of
  /// the axis while the tool is tilted, that is elsewhere at once. On the stem p lies beside its point of the axis.
  [[gnu::noinline]] void run_round(double cosine) {
    const layout::ToolRecord& tool = view_->tools[tool_];
    const double wanted = profile_meridian(tool, point_.z, cosine);
    if (!(point_.z > 0)) {
      const double from = std::fmin(meridian_, profile_stem(tool)), way = wanted - from;
      const bool there = std::fabs(way) <= round_;
      meridian_ = there ? wanted : from + std::copysign(round_, way);
      round_ = there ? round_ - std::fabs(way) : 0;
    } else {
      meridian_ = wanted;
    }
    on_tool_ = profile_point(*view_, tool, meridian_);
  }

  static constexpr Vec3 kAxes[2] = {{0, 0, 1}, {1, 0, 0}};
  // How many times as far as the skin p may run. A tip that rolls runs once as far round itself, the rest is to catch
  // up; along the axis the skin that went farthest counts, for there c runs with p.
  static constexpr double kRound = 3, kAlong = 8;

  const View* view_;
  std::uint32_t tool_;
  double probe_;  ///< m
  bool profile_ = false, lies_ = false;
  detail::If<kSpin, bool> spins_ = {};

  Vec3 point_;  ///< m, p in the tool's frame
  ToolPoint on_tool_;
  PatchRun<kFeatures> run_;
  double meridian_ = 0;                  ///< m, of p on a profile
  double along_ = 0, round_ = 0;         ///< m, that p may run along the axis and round the tip in this tick
  Vec3 axis_;                            ///< of a profile in the last tick
  Vec3 normal_in_tool_;                  ///< n when the tool last turned, in its frame
  Vec3 turned_from_;                     ///< and by the pose of that tick in the body's
  detail::If<kSpin, Vec3[2]> lay_ = {};  ///< where the tool's axes were when its responses were blended
};

}  // namespace palpate::runtime
