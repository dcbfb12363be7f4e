// SPDX-License-Identifier: MIT
// Stiffness factors per site that a host changes while the program runs: tissue that was cut, swells, or is held.
#pragma once

#include "palpate/body/body.hpp"

#include <atomic>

namespace palpate::runtime {

/// A factor per site of a file, 1 at first. Any thread sets factors while force loops read them, and neither waits. The
/// memory is the caller's and must outlive it.
class SiteScales {
public:
  using Scale = std::atomic<float>;
  static_assert(Scale::is_always_lock_free, "a force loop must not wait for a factor");
  static constexpr float kMost = 100;

  /// `scales`: as many as the view has sites.
  SiteScales(const View& view, Scale* scales) : scales_(scales), count_(view.meta->site_count) {
    for (std::uint32_t i = 0; i < count_; ++i) scales_[i].store(1, std::memory_order_relaxed);
  }

  /// Sets the factor of a site. False, and nothing is changed, where the site does not exist or the factor is outside
  /// [0, kMost].
  bool set(std::uint32_t site, float scale) {
    if (site >= count_ || !(scale >= 0 && scale <= kMost)) return false;
    scales_[site].store(scale, std::memory_order_relaxed);
    return true;
  }
  /// The factor of a site that exists.
  [[nodiscard]] float at(std::uint32_t site) const { return scales_[site].load(std::memory_order_relaxed); }

  /// The factor at a point: those of the patch's sites, blended by their weights.
  [[nodiscard]] double at(const View& view, const BodyPoint& point) const {
    double weights[3], sum = 0;
    site_weights(view, point, weights);
    for (int k = 0; k < 3; ++k) sum += weights[k] * double{at(view.triangle(point.triangle).site[k])};
    return sum;
  }

private:
  Scale* scales_;
  std::uint32_t count_;
};

/// A body (any of body/) whose stiffness is scaled at its sites. Force, stiffness and stored energy have the factor, the
/// friction coefficient has not. A factor that rises adds no energy: the hand has to put it in.
template <class Body>
struct StiffnessScale {
  Body body;
  const SiteScales* scales;
  const View* view;
  /// Most that the factor of a contact changes by in a tick, above 0. 0.01 at 1 kHz: from 1 to nothing in 0.1 s.
  double step = 0.01;

  [[nodiscard]] bool valid() const { return body.valid() && step > 0; }
  [[nodiscard]] auto frame(const BodyPoint& at) const { return body.frame(at); }
  [[nodiscard]] const View& surface() const { return body.surface(); }
  [[nodiscard]] auto surface_frame() const { return body.surface_frame(); }
  [[nodiscard]] double travel() const { return body.travel(); }
  [[nodiscard]] double factor(const BodyPoint& at) const { return scales->at(*view, at) * body.factor(at); }
  [[nodiscard]] double factor_step() const { return smaller(step, body.factor_step()); }
};

}  // namespace palpate::runtime
