// SPDX-License-Identifier: MIT
// Responses made softer or stiffer while the program runs: tissue that was cut, swells, or is held.
#pragma once

#include "palpate/contact.hpp"

#include <atomic>
#include <cmath>

namespace palpate::runtime {

/// A factor per site of a file, 1 at first, on all of its responses. Any thread sets factors while force loops read
/// them: neither ever waits. Over memory of the caller, which must outlive it.
class SiteScales {
public:
  using Scale = std::atomic<float>;
  static_assert(Scale::is_always_lock_free);
  static constexpr float kMost = 100;

  /// `scales`: as many as the view has sites.
  SiteScales(const View& view, Scale* scales) : scales_(scales), count_(view.meta->site_count) {
    for (std::uint32_t i = 0; i < count_; ++i) scales_[i].store(1, std::memory_order_relaxed);
  }

  /// Of one site; a region is its sites, one after the other. False, and nothing is changed, where the site does not
  /// exist or the factor is not in [0, kMost].
  bool set(std::uint32_t site, float scale) {
    if (site >= count_ || !(scale >= 0 && scale <= kMost)) return false;
    scales_[site].store(scale, std::memory_order_relaxed);
    return true;
  }
  /// `site` must exist.
  [[nodiscard]] float at(std::uint32_t site) const { return scales_[site].load(std::memory_order_relaxed); }

private:
  Scale* scales_;
  std::uint32_t count_;
};

/// A Contact whose forces are those of the file times the factor at c: the factors of the sites round c, blended by the
/// weights of these sites. It changes by at most `rate` in a second, up or down, so no change tears the force.
/// Setting a factor gives no energy to a tool that is pressed there: one that falls takes force and stored energy with
/// it; one that rises is taken over by a site that c comes to, not by one that has a share in the contact already.
/// Sliding to places of higher factors is as over a body baked so: the force grows along the way, and lifting there
/// gives back what the hand gave, not what the higher stiffness would have stored (energy.hpp).
/// Slip and stick stay those of the file, for the friction limit has the same factor. Grasps have no factors.
/// kFeatures as those of BasicContact.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicAdjustedContact {
public:
  /// View and factors must outlive it and stay where they are. `rate` (1/s, above 0): 10 lets a factor go from 1 to
  /// nothing in 0.1 s.
  BasicAdjustedContact(const View& view, std::uint32_t tool, const SiteScales& scales, double rate = 10)
      : view_(&view), scales_(&scales), contact_(view, tool), rate_(rate) {}
  BasicAdjustedContact(const View&&, std::uint32_t, const SiteScales&, double = 10) = delete;
  BasicAdjustedContact(const View&, std::uint32_t, const SiteScales&&, double = 10) = delete;

  void reset() {
    contact_.reset();
    touching_ = false;
  }

  /// Contact::tick, `seconds` after the one before. Behind a virtual coupling tie.tick(contact, pose, seconds,
  /// seconds).
  Tick tick(const Pose& pose, double seconds) { return scaled(pose, contact_.tick(pose), seconds); }
  Tick tick(const Pose& pose, double seconds, const Search& latest) {
    return scaled(pose, contact_.tick(pose, latest), seconds);
  }

  /// The factor of the last tick in contact.
  [[nodiscard]] double scale() const { return scale_; }
  /// m, BasicContact::size().
  [[nodiscard]] double size() const { return contact_.size(); }
  [[nodiscard]] const BasicContact<kFeatures>& contact() const { return contact_; }

private:
  struct Corner {
    std::uint32_t site = 0;
    double scale = 1;
  };

  Tick scaled(const Pose& pose, Tick tick, double seconds) {
    if (!tick.touches()) {
      touching_ = false;
      return tick;
    }
    const double wanted = blend(tick.at), most = rate_ > 0 && seconds > 0 ? rate_ * seconds : 0;
    // A contact begins with the factor of its place.
    const double before = touching_ ? scale_ : wanted;
    scale_ = touching_ ? std::fmin(std::fmax(wanted, before - most), before + most) : wanted;
    touching_ = true;
    if (scale_ != before) contact_.rescaled(before > 0 ? scale_ / before : HUGE_VAL, pose, tick);
    tick.force = scale_ * tick.force;
    tick.torque = scale_ * tick.torque;
    if (std::isfinite(tick.friction_limit)) tick.friction_limit *= scale_;
    return tick;
  }

  // Corners that c keeps have the least factor since it came to them.
  double blend(const BodyPoint& at) {
    const Corner before[3] = {corner_[0], corner_[1], corner_[2]};
    double weights[3], sum = 0;
    patch_weights(*view_, at, weights);
    for (int k = 0; k < 3; ++k) {
      Corner& corner = corner_[k];
      corner.site = view_->triangles[at.triangle].site[k];
      corner.scale = scales_->at(corner.site);
      for (const Corner& old : before) {
        if (touching_ && old.site == corner.site) corner.scale = std::fmin(corner.scale, old.scale);
      }
      sum += weights[k] * corner.scale;
    }
    return sum;
  }

  const View* view_;
  const SiteScales* scales_;
  BasicContact<kFeatures> contact_;
  double rate_;
  bool touching_ = false;
  Corner corner_[3];
  double scale_ = 1;
};

using AdjustedContact = BasicAdjustedContact<>;

}  // namespace palpate::runtime
