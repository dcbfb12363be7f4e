// SPDX-License-Identifier: MIT
// The local force field of one pair (c, p): responses blended once, then evaluated for any deflection.
#pragma once

#include "palpate/brought.hpp"
#include "palpate/coupled_law.hpp"
#include "palpate/separable.hpp"
#include "palpate/site_laws.hpp"
#include "palpate/spin.hpp"

#include <cmath>

namespace palpate::runtime {

struct FieldForce {
  Vec3 force;       ///< N on the tool, body frame
  Vec3 tangential;  ///< N, its part across n(c), not limited by friction
  double normal = 0;
  double limit = 0;
  double depth = 0;  ///< m
  bool beyond = false;
};

/// Blend of the responses at a body point and a tool point. Fixed size, no allocation. Not for several threads at once:
/// it remembers the parts of its curves that were asked for last, since the next tick asks for the same.
/// Of layout::Feature those that kFeatures leaves out take neither code nor memory; the view must not have them.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicField {
  static constexpr bool kCoupled = (kFeatures & layout::feature_coupled) != 0;
  static constexpr bool kSpin = (kFeatures & layout::feature_spin) != 0;
  static constexpr bool kRelief = (kFeatures & layout::feature_relief) != 0;
  static constexpr bool kBySite = kCoupled && !detail::kSmall;
  using Sites = SiteLaws<kRelief>;
  using Sum = detail::If<kCoupled, coupled::Blend>;

public:
  BasicField() = default;
  /// `tool` is an index into the file's tools; `tool_point.patch` one of that tool's patches.
  BasicField(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point) {
    build(view, tool, body_point, tool_point);
  }
  /// Of a tool that lies so about n(c).
  BasicField(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point,
             const Spin& spin) {
    build_spun(view, tool, body_point, tool_point, runtime::normal(view, body_point), spin);
  }

  /// Of responses that it has already it keeps what it remembers: a field is built again for the same file only.
  void build(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point) {
    const Shares shares(view, tool, body_point, tool_point);
    fetch(view, shares);
    build(view, shares, runtime::normal(view, body_point, shares.site_weight));
  }

  /// The same for a caller that knows n(c) already. Where a tool has spins, of the first.
  void build(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point,
             const Vec3& normal_there) {
    const Shares shares(view, tool, body_point, tool_point);
    fetch(view, shares);
    build(view, shares, normal_there);
  }

  /// Of a tool that lies so about n(c). Apart: what it adds would slow the blends of tools without spins.
  [[gnu::noinline]] void build_spun(const View& view, std::uint32_t tool, const BodyPoint& body_point,
                                    const ToolPoint& tool_point, const Vec3& normal_there, const Spin& spin) {
    if constexpr (kSpin) {
      if (view.spins != nullptr) {
        return blend_spun(view, tool, Shares(view, tool, body_point, tool_point), normal_there, spin);
      }
    }
    build(view, tool, body_point, tool_point, normal_there);
  }

  [[nodiscard]] const Vec3& normal() const { return normal_; }
  /// Of a coupled file, what the blend is made of.
  [[nodiscard]] const coupled::Law& law() const { return coupled_.law(); }
  /// Share of the blend that was refused and taken from neighbours, [0, 1].
  [[nodiscard]] double covered() const { return covered_; }
  /// k of BasicRelief; 0 in a file without.
  [[nodiscard]] double relief() const {
    if constexpr (kRelief) return relief_;
    return 0;
  }
  /// How deep the blended responses were sampled (m).
  [[nodiscard]] double depth_limit() const { return limit_; }

  /// Terms at depth z (m); depth, forces and limit are zero for z <= 0.
  [[nodiscard]] DepthTerms at_depth(double z) const {
    DepthTerms terms;
    if (z > 0) set_depth(z, terms);
    return terms;
  }
  /// The same in place: terms are large.
  void set_depth(double z, DepthTerms& terms) const {
    if (!(z > 0)) {
      terms = {};
      return;
    }
    if constexpr (kCoupled) {
      if (is_coupled()) coupled_at(z, terms);
    }
    if (!is_coupled()) separable_.at_depth(z, terms);
    terms.depth = z;
    terms.beyond = z > limit_ * kLimitSlack;
  }

  /// Terms that suffice for stored() only.
  [[nodiscard]] DepthTerms energy_terms(double z) const {
    DepthTerms terms;
    if (!(z > 0)) return terms;
    if constexpr (kCoupled) {
      if (is_coupled()) coupled_at(z, terms);
    }
    if (!is_coupled()) terms.straight = separable_.straight_once(z);
    terms.depth = z;
    return terms;
  }

  /// Sideways force at a sideways deflection (m, body frame; its part along n(c) does not count). Which part of the
  /// contact asks makes it no other, but faster.
  [[nodiscard]] PALPATE_TICK_INLINE Vec3 sideways(const DepthTerms& terms, const Vec3& deflection,
                                                  Part part = Part::core) const {
    return in_space(sideways(terms, in_plane(deflection), part));
  }
  /// The same in the plane across n(c).
  [[nodiscard]] PALPATE_TICK_INLINE coupled::Vec2 sideways(const DepthTerms& terms, const coupled::Vec2& deflection,
                                                           Part part) const {
    if (!(terms.depth > 0)) return {};
    if constexpr (kCoupled) {
      if (is_coupled()) return coupled_.sideways(terms.coupled, deflection);
    }
    return separable_.sideways(terms, deflection, part);
  }
  /// What of a vector lies in that plane, by its basis there; and back.
  [[nodiscard]] coupled::Vec2 in_plane(const Vec3& v) const { return {dot(v, basis_x_), dot(v, basis_y_)}; }
  [[nodiscard]] Vec3 in_space(const coupled::Vec2& v) const { return v.x * basis_x_ + v.y * basis_y_; }

  /// Adds what a sideways deflection does to the normal force; the limit stays that of the straight push. `across` is
  /// the whole force across n(c) there.
  void couple(DepthTerms& terms, const Vec3& deflection, const Vec3& across) const {
    if constexpr (kCoupled) {
      if (!is_coupled() || !(terms.depth > 0)) return;
      terms.normal_force += coupled_.coupling(terms.coupled, in_plane(deflection), in_plane(across));
    }
  }
  /// The same of the two parts of a contact: their deflections (m) and shares, and how many times as much they bear of
  /// the straight push's sideways force.
  void couple(DepthTerms& terms, const Vec3 (&deflection)[2], const double (&share)[2], const double (&lean)[2]) const {
    if constexpr (kCoupled) {
      if (!is_coupled() || !(terms.depth > 0)) return;
      const Two both = coupled_.coupling(terms.coupled, {in_plane(deflection[0]), in_plane(deflection[1])}, lean);
      terms.normal_force += share[0] * both[0] + share[1] * both[1];
    }
  }

  /// The sideways deflection (m) that a contact keeps when it goes deeper from z0 to z1 > z0 >= 0 without moving
  /// sideways: less, for new area is anchored unstressed.
  [[nodiscard]] Vec3 deepened(double z0, double z1, const Vec3& deflection) const {
    return deepened(z0, at_depth(z1), deflection);
  }
  /// The same for a caller that has the terms at z1.
  [[nodiscard, gnu::noinline]] Vec3 deepened(double z0, const DepthTerms& at_z1, const Vec3& deflection) const {
    if (!(z0 > 0)) return {};
    if constexpr (kCoupled) {
      if (is_coupled()) {
        return in_space(coupled_.deepened(z0, at_z1.depth, at_z1.coupled, in_plane(deflection)));
      }
    }
    return separable_.share_kept(z0, at_z1) * deflection;
  }
  /// The same of the two parts of a contact, in place.
  [[gnu::noinline]] void deepen(double z0, const DepthTerms& at_z1, Vec3 (&deflection)[2],
                                const double (&lean)[2]) const {
    if constexpr (kCoupled) {
      if (is_coupled() && z0 > 0) {
        coupled::Vec2 both[2] = {in_plane(deflection[0]), in_plane(deflection[1])};
        coupled_.deepen(z0, at_z1.depth, at_z1.coupled, both, lean);
        for (int k = 0; k < 2; ++k) deflection[k] = in_space(both[k]);
        return;
      }
    }
    const double kept = z0 > 0 ? separable_.share_kept(z0, at_z1) : 0;
    for (Vec3& each : deflection) each = kept * each;
  }

  /// The sideways stiffness at a depth z > 0 over that at the terms' depth, or the other way round where that is less.
  [[nodiscard, gnu::noinline]] double share_between(double z, const DepthTerms& terms) const {
    if constexpr (kCoupled) {
      if (is_coupled()) return coupled_.share_between(z, terms.depth, terms.coupled);
    }
    return separable_.share_between(z, terms);
  }

  /// J by which the deflection `after` holds less at these terms than `before` (m) at a depth z > 0, of a coupled file.
  /// The sideways forces of a separable one are no gradient: 0.
  [[nodiscard, gnu::noinline]] double released(double z, const Vec3& before, const DepthTerms& terms, const Vec3& after,
                                               double lean = 1) const {
    if constexpr (kCoupled) {
      if (is_coupled()) {
        return coupled_.released(z, in_plane(before), terms.depth, terms.coupled, in_plane(after), lean);
      }
    }
    return 0;
  }

  /// Says that deepened() will be asked for these terms' depth as z0.
  void remember(const DepthTerms& terms) const {
    if constexpr (kCoupled) {
      if (is_coupled()) return coupled_.remember(terms.depth, terms.coupled);
    }
    separable_.remember(terms);
  }

  /// What the deflection stores (J). The sideways forces of a separable response are no gradient: what they take is
  /// not counted here (StrainTally does). `lean` as in couple().
  [[nodiscard, gnu::noinline]] double stored(const DepthTerms& terms, const Vec3& deflection, double lean = 1) const {
    if (!(terms.depth > 0)) return 0;
    if constexpr (kCoupled) {
      if (is_coupled()) {
        return coupled_.pushed(terms.depth) + coupled_.energy(terms.coupled, in_plane(deflection), lean);
      }
    }
    return separable_.pushed(terms.depth) - lean * dot(terms.straight, deflection);
  }

  /// Force of a whole deflection p - c (m, body frame), sticking. Zero where its depth is not positive.
  [[nodiscard]] FieldForce force(const Vec3& deflection) const {
    if constexpr (kCoupled) {
      if (is_coupled()) return coupled_force(deflection);
    }
    FieldForce result;
    const double depth = -dot(deflection, normal_);
    if (!(depth > 0)) return result;
    DepthTerms terms;
    separable_.at_depth(depth, terms);
    result.tangential = terms.straight + in_space(separable_.sideways(terms, in_plane(deflection), Part::core));
    result.normal = terms.normal_force;
    result.limit = terms.limit;
    end(depth, result);
    return result;
  }

  /// The file's responses are of the coupled model.
  [[nodiscard]] bool is_coupled() const { return kCoupled && view_->coupled; }

private:
  /// The rest of what the normal and the sideways force at a depth make.
  PALPATE_TICK_INLINE void end(double depth, FieldForce& result) const {
    result.force = result.normal * normal_ + result.tangential;
    result.depth = depth;
    result.beyond = depth > limit_ * kLimitSlack;
  }

  [[nodiscard, gnu::noinline]] FieldForce coupled_force(const Vec3& deflection) const {
    FieldForce result;
    const double depth = -dot(deflection, normal_);
    if (!(depth > 0)) return result;
    const CoupledLaw::Force answer = coupled_.force(depth, in_plane(deflection));
    result.tangential = in_space(answer.sideways);
    result.normal = answer.normal;
    result.limit = answer.limit;
    end(depth, result);
    return result;
  }

  /// The sites and tool vertices of a contact.
  struct Shares {
    Shares(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point)
        : sites(view.triangles[body_point.triangle].site), corners(tool_corners<kFeatures>(view, tool, tool_point)) {
      patch_weights(view, body_point, site_weight);
    }
    const std::uint32_t (&sites)[3];
    double site_weight[3];
    ToolCorners corners;
  };

  /// Has the responses brought, while the normal is made.
  void fetch(const View& view, const Shares& shares) {
    [[maybe_unused]] const bool again = brought_.again(view, shares.sites, shares.corners);
    if constexpr (kBySite) {
      if (view.coupled) by_site_ = site_laws_.choose(view, shares.sites, shares.corners, again);
    }
  }

  /// Of the first spins.
  void build(const View& view, const Shares& shares, const Vec3& normal_there) {
    begin(view, normal_there);
    Across axis[3];  // all at once: each is a long chain of dependent operations
    for (int k = 0; k < 3; ++k) axis[k] = sideways_axis(shares.sites[k]);
    if constexpr (kBySite) {
      if (is_coupled() && by_site_) return blend_sites(shares, axis);
    }
    Sum sum = begin_sum();
    for (int l = 0; l < shares.corners.count; ++l) {
      for (int k = 0; k < 3; ++k) {
        const std::uint64_t index = layout::response_index(*view.meta, shares.sites[k], shares.corners.vertex[l]);
        add<false>(sum, index, shares.site_weight[k] * shares.corners.weight[l], axis[k]);
      }
    }
    end_sum(sum);
  }

  /// Of a coupled file, by what the sites are known to answer at this point of the tool.
  void blend_sites(const Shares& shares, const Across (&axis)[3]) {
    coupled::Rows::Share parts[3];
    for (int k = 0; k < 3; ++k) {
      const typename Sites::SiteLaw& law = site_laws_.look(*view_, shares.sites, k);
      const double weight = shares.site_weight[k];
      parts[k] = {&law.rows, weight, {axis[k].cosine, axis[k].sine}};
      limit_ += weight * law.limit;
      covered_ += weight * law.covered;
      if constexpr (kRelief) relief_ += weight * law.relief;
    }
    coupled_.set(parts);
  }

  /// Of two spins of each tool vertex, or three, each with an x axis of its own.
  void blend_spun(const View& view, std::uint32_t tool, const Shares& shares, const Vec3& normal_there,
                  const Spin& spin) {
    begin(view, normal_there);
    Sum sum = begin_sum();
    Across axis[3];
    for (int k = 0; k < 3; ++k) axis[k] = sideways_axis(shares.sites[k]);
    const SpunSites spun(view, view.tools[tool], spin, normal_, basis_x_, basis_y_, axis, spin_step_);
    for (int l = 0; l < shares.corners.count; ++l) {
      const std::uint32_t vertex = shares.corners.vertex[l];
      spun.for_each(vertex, [&](int k, std::uint32_t sample, double share, const Across& x) {
        const std::uint64_t index = layout::response_index(*view.meta, shares.sites[k], vertex) + sample;
        add<true>(sum, index, shares.site_weight[k] * shares.corners.weight[l] * share, x);
      });
    }
    end_sum(sum);
  }

  /// Forgets all responses.
  void begin(const View& view, const Vec3& normal_there) {
    view_ = &view;
    const layout::Meta& m = *view.meta;
    normal_ = normal_there;
    basis_x_ = any_orthogonal(normal_);
    basis_y_ = cross(normal_, basis_x_);
    covered_ = limit_ = 0;
    if constexpr (kRelief) relief_ = 0;
    if constexpr (kCoupled) {
      if (is_coupled()) return coupled_.clear(m);
    }
    separable_.clear(m, basis_x_, basis_y_);
  }

  [[gnu::noinline]] void coupled_at(double z, DepthTerms& terms) const {
    coupled_.at_depth(z, terms.coupled);
    terms.root = terms.coupled.s;
    terms.normal_force = terms.coupled.push;
    terms.limit = terms.coupled.limit * terms.coupled.push;
    terms.straight = -terms.coupled.straight.x * basis_x_ - terms.coupled.straight.y * basis_y_;
  }

  /// The x axis of a site's frame, carried to c, in the basis; any where nothing lies sideways.
  [[nodiscard]] Across sideways_axis(std::uint32_t site) const {
    constexpr std::uint32_t kSideways =
        kFeatures & (layout::feature_lateral | layout::feature_friction | layout::feature_spin);
    if ((view_->features & kSideways) == 0) return {};
    return carried_axis(view_->sites[site], normal_, basis_x_, basis_y_);
  }

  [[nodiscard]] Sum begin_sum() const {
    Sum sum;
    if constexpr (kCoupled) {
      if (is_coupled()) sum.clear(layout::coupled_degrees(*view_->meta));
    }
    return sum;
  }
  void end_sum([[maybe_unused]] const Sum& sum) {
    if constexpr (kCoupled) {
      if (is_coupled()) coupled_.set(sum);
    }
  }

  /// kSpun: one of up to three spins of a tool vertex at a site, each with an x axis of its own.
  template <bool kSpun>
  void add([[maybe_unused]] Sum& sum, std::uint64_t index, double weight, const Across& x) {
    const layout::ResponseHead& head = view_->response_head(index);
    limit_ += weight * head.depth_limit;
    const bool covered = (head.flags & layout::response_covered) != 0;
    if constexpr (detail::kSmall) {
      if (covered) covered_ += weight;
    } else {
      covered_ += static_cast<double>(covered) * weight;  // nobody foretells a branch
    }
    if constexpr (kRelief) {
      if (view_->head_size > sizeof(layout::ResponseHead)) relief_ += weight * view_->relief(index);
    }
    if constexpr (kCoupled) {
      if (is_coupled()) {
        return with_law(*view_, index, sum.places(), [&](const auto* coefs, const auto* limits, double unit) {
          sum.add(coefs, limits, unit, layout::kLimitUnit, weight, {x.cosine, x.sine});
        });
      }
    }
    separable_.template add<kSpun>(*view_, index, weight, x);
  }

  /// Limits are stored as floats: a push to just the sampled depth must not count as beyond it.
  static constexpr double kLimitSlack = 1 + 1e-5;

  const View* view_ = nullptr;
  Vec3 normal_, basis_x_, basis_y_;
  double covered_ = 0, limit_ = 0;
  detail::If<kRelief, double> relief_ = {};
  SeparableLaw<kFeatures> separable_;
  detail::If<kCoupled, CoupledLaw> coupled_;
  detail::If<kBySite, Sites> site_laws_;
  detail::If<kBySite, bool> by_site_ = {};
  Brought<!detail::kSmall> brought_;
  detail::If<kSpin, SpinStep> spin_step_;
};

using Field = BasicField<>;

}  // namespace palpate::runtime
