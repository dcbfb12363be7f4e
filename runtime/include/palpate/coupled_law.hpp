// SPDX-License-Identifier: MIT
// The coupled response of one contact, in newtons and metres, with what it knows of the depths asked for last.
#pragma once

#include "palpate/depth_terms.hpp"
#include "palpate/response_layout.hpp"

namespace palpate::runtime {

/// Blend of the coupled responses round a contact. Vectors are in the basis across n(c), deflections in m. `lean`: how
/// many times as much a part of the contact bears of the straight push's sideways force. Not for several threads at
/// once: it remembers the terms of a depth, since the next tick asks for the same.
/// What only this model needs stays out of line: inlined into a tick it would slow the other by a tenth.
class CoupledLaw {
public:
  using Vec2 = coupled::Vec2;
  using AtDepth = coupled::AtDepth;

  /// Forgets all responses; the law of new ones is set() after that.
  void clear(const layout::Meta& meta) {
    meta_ = &meta;
    per_scale_ = meta.sideways_scale > 0 ? 1 / static_cast<double>(meta.sideways_scale) : 0;
    known_depth_ = 0;
  }
  /// Of what coupled::Law takes.
  template <class Blend>
  void set(const Blend& blend) {
    law_.set(blend, meta_->depth_scale, meta_->sideways_scale);
  }
  [[nodiscard]] const coupled::Law& law() const { return law_; }

  /// At a depth z > 0 (m).
  [[gnu::noinline]] void at_depth(double z, AtDepth& d) const { law_.set_at(law_.abscissa(z), false, d); }

  /// Sideways force (N) without that of the straight push.
  [[nodiscard, gnu::noinline]] Vec2 sideways(const AtDepth& d, const Vec2& deflection) const {
    return -1 * d.energy.gradient(per_scale_ * deflection, law_.degrees().order);
  }

  /// N, what the deflection does to the normal force; `across` (N) is the whole force across n(c) there.
  [[nodiscard, gnu::noinline]] double coupling(const AtDepth& d, const Vec2& deflection, const Vec2& across) const {
    return law_.coupling(d, per_scale_ * deflection, [&] { return -1 * across; });
  }
  /// The same of two parts of a contact.
  [[nodiscard, gnu::noinline]] Two coupling(const AtDepth& d, const Vec2 (&deflection)[2],
                                            const double (&lean)[2]) const {
    Two both{};
    if (kTwoARegister && law_.couple_at_once(d, beside(deflection), two(lean[0], lean[1]), both)) return both;
    for (int k = 0; k < 2; ++k) {
      const Vec2 u = per_scale_ * deflection[k];
      both[k] = law_.coupling(
          d, u, [&] { return lean[k] * d.straight + d.energy.gradient(u, law_.degrees().order); }, lean[k]);
    }
    return both;
  }

  /// What a contact keeps of a deflection when it goes deeper from z0 > 0 to z1 > z0 without moving sideways.
  [[nodiscard, gnu::noinline]] Vec2 deepened(double z0, double z1, const AtDepth& at_z1, const Vec2& deflection) const {
    const double t0 = law_.abscissa(z0);
    know(z0, t0);
    return meta_->sideways_scale * law_.deepen(t0, known_, law_.abscissa(z1), at_z1, per_scale_ * deflection);
  }
  /// The same of two parts of a contact.
  [[gnu::noinline]] void deepen(double z0, double z1, const AtDepth& at_z1, Vec2 (&deflection)[2],
                                const double (&lean)[2]) const {
    const double t0 = law_.abscissa(z0), t1 = law_.abscissa(z1), scale = meta_->sideways_scale;
    know(z0, t0);
    if constexpr (kTwoARegister) {
      coupled::Vec2Of<Two> u = beside(deflection);
      if (law_.deepen_at_once(t0, known_, t1, at_z1, u, two(lean[0], lean[1]))) {
        for (int k = 0; k < 2; ++k) deflection[k] = {scale * u.x[k], scale * u.y[k]};
        return;
      }
    }
    for (int k = 0; k < 2; ++k) {
      deflection[k] = scale * law_.deepen(t0, known_, t1, at_z1, per_scale_ * deflection[k], lean[k]);
    }
  }

  /// The sideways stiffness at a depth z > 0 over that at z1, or the other way round where that is less.
  [[nodiscard]] double share_between(double z, double z1, const AtDepth& at_z1) const {
    const double there = known_at(z).energy.square.m, here = at_z1.energy.square.m;
    const double share = z1 > z ? there / here : here / there;
    return share > 0 && share < 1 ? share : 1;
  }

  /// J by which the deflection `after` holds less at z1 than `before` at a depth z > 0.
  [[nodiscard]] double released(double z, const Vec2& before, double z1, const AtDepth& at_z1, const Vec2& after,
                                double lean) const {
    return energy(z == z1 ? at_z1 : known_at(z), before, lean) - energy(at_z1, after, lean);
  }

  /// J, of the straight push to a depth z > 0.
  [[nodiscard]] double pushed(double z) const { return law_.pushed(law_.abscissa(z)); }
  /// J that a deflection holds.
  [[nodiscard]] double energy(const AtDepth& d, const Vec2& deflection, double lean) const {
    const Vec2 u = per_scale_ * deflection;
    return meta_->sideways_scale * (law_.energy(d, u) + (lean - 1) * dot(d.straight, u));
  }

  /// N, normal and sideways, of a whole deflection at a depth z > 0, sticking; mu times the normal force alone.
  struct Force {
    double normal, limit;
    Vec2 sideways;
  };
  [[nodiscard]] Force force(double z, const Vec2& deflection) const {
    AtDepth d;
    law_.set_at(law_.abscissa(z), false, d);
    const Vec2 u = per_scale_ * deflection, push = law_.push(d, u);
    return {d.push + law_.coupling(d, u, [&] { return push; }), d.limit * d.push, -1 * push};
  }

  /// Says that z0 will be this depth.
  void remember(double z, const AtDepth& d) const {
    known_depth_ = z;
    known_ = d;
  }

private:
  [[nodiscard]] coupled::Vec2Of<Two> beside(const Vec2 (&deflection)[2]) const {
    return per_scale_ *
           coupled::Vec2Of<Two>{two(deflection[0].x, deflection[1].x), two(deflection[0].y, deflection[1].y)};
  }

  void know(double z, double t) const {
    if (known_depth_ == z) return;
    known_depth_ = z;
    law_.set_at(t, true, known_);
  }
  [[nodiscard, gnu::noinline]] const AtDepth& known_at(double z) const {
    know(z, law_.abscissa(z));
    return known_;
  }

  const layout::Meta* meta_ = nullptr;
  double per_scale_ = 0;  ///< 1 / X (1/m)
  coupled::Law law_;
  mutable double known_depth_ = 0;  ///< m; none where it is 0
  mutable AtDepth known_{};
};

}  // namespace palpate::runtime
