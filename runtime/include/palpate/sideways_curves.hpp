// SPDX-License-Identifier: MIT
// Sideways curves of separable responses side by side: what grows with the depth, what follows a deflection.
#pragma once

#include "palpate/depth_terms.hpp"
#include "palpate/math3.hpp"
#include "palpate/pieces.hpp"
#include "palpate/view.hpp"

namespace palpate::runtime {

/// Sideways forces g(z) phi(r) of responses, each in its body vertex' frame, in layers of three: a vertex of the tool,
/// or a spin of it, at each site of the patch. All that a tick asks for is computed for the six curves of a layer at
/// once (first x and y of the first site, then of the second, ...), so that compilers use vectors; r, which is the
/// site's, for all layers. What was asked for last is remembered for kParts deflections, each for itself: those of a
/// contact's core and rim (rim.hpp). Not for several threads at once.
template <int kParts, int kLayers>
class SidewaysCurves {
public:
  static constexpr int kSites = 3, kLanes = 2 * kSites;
  using Lanes = runtime::Lanes<kLanes>;
  using Growths = Lanes[kLayers];

  /// Of which file the responses are that are set from now on.
  void begin(const layout::Meta& meta) {
    growth_count_ = static_cast<int>(meta.growth_coefs);
    sideways_count_ = static_cast<int>(meta.sideways_coefs);
    half_ = 0.5 * (sideways_count_ - 3);
    kept_ = layers_;
    layers_ = 0;
  }

  /// Response k of a layer, each of them once, layer by layer: its coefficients (gx, gy, phix, phiy), its weight, the
  /// angle of its x axis. Where it is the one that was there before, as while c slides within a patch, what is
  /// remembered of its curves stays good. kApart: the axis is the response's own, and not its site's.
  template <bool kApart>
  void set(int layer, int k, const float* coefs, double weight, double cosine, double sine) {
    layers_ = layer + 1;
    if (apart_ != kApart) {
      apart_ = kApart;
      kept_ = 0;
    }
    if (layer >= kept_ || layer_[layer].coefs[k] != coefs) take_over(layer, k, coefs);
    layer_[layer].weight.of[k] = two(weight, weight);
    if (!kApart && layer > 0) return;
    layer_[layer].cosine.of[k] = two(cosine, cosine);
    layer_[layer].sine.of[k] = two(sine, -sine);
  }

  [[nodiscard]] int layers() const { return layers_; }

  /// Every response has an axis of its own: there are many, and mostly others in the next tick. Intervals of their
  /// growths are not worth taking.
  [[nodiscard]] bool apart() const { return apart_; }

  /// Weighted growths where all are on the interval taken; t: in intervals.
  void growths(double t, Lanes* growth) const {
    const double share = t - growth_interval_;
    if (__builtin_expect(falls_, false)) return growths_or_none(share, growth);
    each_layer([&](int j) PALPATE_INLINE_LAMBDA { set_growth(j, share, growth[j]); });
  }

  /// Weighted growths at s of all that are apart, or where nobody is soon to ask again: takes no intervals.
  void growths_once(double s, Lanes* growth) const {
    const spline::Basis basis = spline::basis_onwards(growth_count_, s);
    for (int j = 0; j < layers_; ++j) {
      Lanes g;
      for (int k = 0; k < kSites; ++k) {
        g.of[k] =
            two(spline::combine(basis, growth_coefs(j, 2 * k)), spline::combine(basis, growth_coefs(j, 2 * k + 1)));
      }
      weigh(j, g, growth[j]);
      clamp(growth[j]);
    }
  }

  /// Takes the interval at t, which is returned.
  int take_growths(double t) const {
    const int interval = spline::interval_onwards(growth_count_, t);
    if (interval == growth_interval_) return interval;
    const spline::Interval at(growth_count_, interval);
    for (int j = 0; j < layers_; ++j) {
      for (int k = 0; k < kSites; ++k) take_growth(j, k, at, interval);
    }
    growth_interval_ = interval;
    falls_ = false;
    for (int j = 0; interval == growth_count_ - 3 && j < layers_; ++j) {
      for (int lane = 0; lane < kLanes; ++lane) falls_ = falls_ || layer_[j].growth.cubic(lane).power[1] < 0;
    }
    return interval;
  }

  /// Force (N) at a deflection x, y (of the sideways scale) of a part.
  [[nodiscard]] PALPATE_TICK_INLINE Two force(const Lanes* growth, int part, double x, double y) const {
    if (apart_) return force_apart(growth, part, x, y);
    const Lanes share = find<false>(part, 0, x, y);
    Lanes phi, f;
    each_layer([&](int j) PALPATE_INLINE_LAMBDA {
      layer_[j].phi[part].at(share, phi);
      unrolled<kSites>([&](int k) PALPATE_INLINE_LAMBDA {
        const Two each = growth[j].of[k] * phi.of[k];
        f.of[k] = j == 0 ? each : f.of[k] + each;
      });
    });
    return turned(0, 0, f.of[0]) + turned(0, 1, f.of[1]) + turned(0, 2, f.of[2]);
  }

private:
  // All of a layer lies together, near enough for a microcontroller to reach it from one address.
  struct Layer {
    Pieces<kLanes> growth, phi[kParts];
    Lanes weight = {}, cosine = {}, sine = {};  ///< the sine of each y is the negative
    const float* coefs[kSites] = {};
  };

  /// The layers that are there without spins, one by one: of a loop compilers would put two beside each other and take
  /// what is left number by number.
  template <class Each>
  PALPATE_TICK_INLINE void each_layer(const Each& each) const {
    each(0);
    if (layers_ > 1) each(1);
    if (layers_ > 2) each(2);
  }

  PALPATE_TICK_INLINE void set_growth(int layer, double share, Lanes& growth) const {
    Lanes g;
    layer_[layer].growth.all_at(share, g);
    weigh(layer, g, growth);
  }
  /// No coefficient is negative, so only beyond its end a growth may fall below 0: it is 0 there.
  [[gnu::noinline]] void growths_or_none(double share, Lanes* growth) const {
    for (int j = 0; j < layers_; ++j) {
      set_growth(j, share, growth[j]);
      clamp(growth[j]);
    }
  }

  PALPATE_TICK_INLINE void take_growth(int layer, int k, const spline::Interval& at, int interval) const {
    const Pieces<kLanes>& growth = layer_[layer].growth;
    if (growth.interval(2 * k) == interval) return;
    const float *x = growth_coefs(layer, 2 * k) + at.first(), *y = x + growth_count_;
    growth.take_two(k, x, y, at, interval);
  }

  /// The same where every response has an axis of its own.
  [[gnu::noinline]] Two force_apart(const Lanes* growth, int part, double x, double y) const {
    Two force = two(0, 0);
    for (int j = 0; j < layers_; ++j) {
      Lanes phi;
      layer_[j].phi[part].at(find<true>(part, j, x, y), phi);
      for (int k = 0; k < kSites; ++k) force += turned(j, k, growth[j].of[k] * phi.of[k]);
    }
    return force;
  }

  /// Shares of the intervals of phi on which a deflection lies, of a layer or of all that lie as the first; they are
  /// taken where they are others.
  template <bool kApart>
  [[nodiscard]] PALPATE_TICK_INLINE Lanes find(int part, int layer, double x, double y) const {
    const Layer& asked = layer_[layer];
    Lanes t, share;
    turn_in(asked, x, y, t);
    return asked.phi[part].shares(t, share) ? share : take_phi<kApart>(asked, part, t.of[0], t.of[1], t.of[2]);
  }
  // Rarely called, and long: inlined it would slow every tick. What is asked for comes in registers, site by site; the
  // layer is the first where all lie alike.
  template <bool kApart>
  [[gnu::noinline]] Lanes take_phi(const Layer& asked, int part, Two t0, Two t1, Two t2) const {
    const Lanes t = {{t0, t1, t2}};
    const Pieces<kLanes>& phi = asked.phi[part];
    const int count = sideways_count_;
    unrolled<kLanes>([&](int k) PALPATE_INLINE_LAMBDA {
      if (phi.on_interval(k, t[k])) return;
      const int interval = spline::interval_onwards(count, t[k]);
      const spline::Interval at(count, interval);
      if (!at.inside() && phi.interval(k) == interval) return;
      phi.take(k, phi_coefs(asked, k), at, interval);
      if constexpr (kApart) return;
      for (int j = 1; j < layers_; ++j) layer_[j].phi[part].take(k, phi_coefs(layer_[j], k), at, interval);
    });
    Lanes share;
    phi.shares(t, share);  // beyond the scale they are no shares, but how far
    return share;
  }

  /// What was remembered there is of another response, or of other intervals than the layers' before it.
  void take_over(int layer, int k, const float* coefs) {
    layer_[layer].coefs[k] = coefs;
    for (int part = 0; part < kParts; ++part) layer_[layer].phi[part].forget(k);
    if (apart_) return;
    for (int part = 0; part < kParts; ++part) layer_[0].phi[part].forget(k);  // which is asked for all
    layer_[layer].growth.forget(k);
    growth_interval_ = -1;
  }

  [[nodiscard]] const float* growth_coefs(int layer, int lane) const {
    return layer_[layer].coefs[lane / 2] + (lane % 2) * growth_count_;
  }
  [[nodiscard]] const float* phi_coefs(const Layer& layer, int lane) const {
    return layer.coefs[lane / 2] + 2 * growth_count_ + (lane % 2) * sideways_count_;
  }

  void weigh(int layer, const Lanes& g, Lanes& growth) const {
    unrolled<kSites>([&](int k) PALPATE_INLINE_LAMBDA { growth.of[k] = layer_[layer].weight.of[k] * g.of[k]; });
  }
  static void clamp(Lanes& growth) {
    for (int k = 0; k < kSites; ++k) growth.of[k] = positive(growth.of[k]);
  }

  /// A deflection (of the scale) in the frames of a layer, in intervals of phi.
  void turn_in(const Layer& layer, double x, double y, Lanes& t) const {
    const double u = half_ * x, v = half_ * y;
    unrolled<kSites>([&](int k) PALPATE_INLINE_LAMBDA {
      t.of[k] = two(half_, half_) + layer.cosine.of[k] * two(u, v) + layer.sine.of[k] * two(v, u);
    });
  }

  /// From the frame of site k of a layer.
  [[nodiscard]] Two turned(int layer, int k, const Two& f) const {
    return layer_[layer].cosine.of[k] * f - layer_[layer].sine.of[k] * swapped(f);
  }

  Layer layer_[kLayers];
  int growth_count_ = 0, sideways_count_ = 0, layers_ = 0;
  double half_ = 0;                      ///< of the knot intervals of phi
  int kept_ = 0;                         ///< layers that the blend before this one had, in frames like these
  bool apart_ = false;                   ///< each response has its own axis
  mutable double growth_interval_ = -1;  ///< that all growths are taken on; -1 where some are not
  mutable bool falls_ = false;           ///< one of them falls on that
};

}  // namespace palpate::runtime
