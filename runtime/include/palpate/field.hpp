// SPDX-License-Identifier: MIT
// The local force field of one pair (c, p): responses blended once, then evaluated for any deflection.
#pragma once

#include "palpate/coupled.hpp"
#include "palpate/spline.hpp"
#include "palpate/surface.hpp"

#include <cmath>

namespace palpate::runtime {

/// What depends on the depth alone; valid for the field that made it.
struct DepthTerms {
  double depth = 0;         ///< m
  double normal_force = 0;  ///< N along n(c)
  double limit = 0;         ///< N, largest tangential force: mu(depth) Fn; infinite in a frictionless file
  Vec3 straight;            ///< N, sideways force of the straight push, across n(c)
  union {
    double growth[9][2] = {};
    coupled::AtDepth coupled;  ///< in a file of the coupled model
  };
  bool beyond = false;  ///< deeper than this pair was sampled
};

struct FieldForce {
  Vec3 force;       ///< N on the tool, body frame
  Vec3 tangential;  ///< N, its part across n(c), not limited by friction
  double normal = 0;
  double limit = 0;
  double depth = 0;  ///< m
  bool beyond = false;
};

/// Blend of the responses at a body point and a tool point. Fixed size, no allocation.
class Field {
public:
  Field() = default;
  /// `tool` is an index into the file's tools; `tool_point.patch` one of that tool's patches.
  Field(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point) {
    build(view, tool, body_point, tool_point);
  }

  void build(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point) {
    build(view, tool, body_point, tool_point, runtime::normal(view, body_point));
  }

  /// The same for a caller that knows n(c) already.
  void build(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point,
             const Vec3& normal_there) {
    view_ = &view;
    const layout::Meta& m = *view.meta;
    normal_ = normal_there;
    basis_x_ = any_orthogonal(normal_);
    basis_y_ = cross(normal_, basis_x_);
    for (std::uint32_t k = 0; k < m.normal_coefs; ++k) push_[k] = 0;
    for (std::uint32_t k = 0; k < m.lateral_coefs; ++k) lateral_x_[k] = lateral_y_[k] = 0;
    for (std::uint32_t k = 0; k < m.friction_coefs; ++k) mu_[k] = 0;
    if (view.coupled_laws != nullptr) law_.clear(layout::coupled_degrees(m), m.depth_scale, m.sideways_scale);
    per_scale_ = m.sideways_scale > 0 ? 1 / m.sideways_scale : 0;
    covered_ = limit_ = 0;
    bodies_ = pairs_ = 0;
    add_bodies(body_point);
    std::uint32_t corner[3];
    double weight[3];
    const int corners = tool_corners(view, tool, tool_point, corner, weight);
    const layout::Patch& patch = view.patches[view.triangles[body_point.triangle].patch];
    for (int i = 0; i < bodies_; ++i) {
      body_[i].first_pair = pairs_;
      for (int l = 0; l < corners; ++l) {
        add_pair(body_[i], layout::response_index(m, patch.vertex[body_[i].corner], corner[l]),
                 body_[i].weight * weight[l]);
      }
    }
    body_[bodies_].first_pair = pairs_;
    if (view.coupled_laws != nullptr) law_.finish();
  }

  [[nodiscard]] const Vec3& normal() const { return normal_; }
  /// Share of the blend that was refused and taken from neighbours, [0, 1].
  [[nodiscard]] double covered() const { return covered_; }
  /// How deep the blended responses were sampled (m).
  [[nodiscard]] double depth_limit() const { return limit_; }

  /// Terms at depth z (m); all zero for z <= 0.
  [[nodiscard]] DepthTerms at_depth(double z) const {
    return view_->coupled_laws != nullptr ? coupled_at(z) : separable_at(z);
  }

  /// Sideways force at a sideways deflection (m, body frame; its part along n(c) does not count).
  [[nodiscard]] Vec3 sideways(const DepthTerms& terms, const Vec3& deflection) const {
    Vec3 force;
    const layout::Meta& m = *view_->meta;
    if (view_->coupled_laws != nullptr) return coupled_sideways(terms, deflection);
    if (m.sideways_coefs == 0 || !(terms.depth > 0)) return force;
    const int count = static_cast<int>(m.sideways_coefs);
    for (int i = 0; i < bodies_; ++i) {
      const Body& body = body_[i];
      const Along x(count, dot(deflection, body.x) * per_scale_);
      const Along y(count, dot(deflection, body.y) * per_scale_);
      double fx = 0, fy = 0;
      for (int j = body.first_pair; j < body_[i + 1].first_pair; ++j) {
        const float* phi = pair_[j].coefs + 2 * m.growth_coefs;
        fx += terms.growth[j][0] * x.value(phi, count);
        fy += terms.growth[j][1] * y.value(phi + count, count);
      }
      force = force + fx * body.x + fy * body.y;
    }
    return force;
  }

  /// Adds what a sideways deflection does to the normal force; the limit stays that of the straight push.
  void couple(DepthTerms& terms, const Vec3& deflection) const {
    if (view_->coupled_laws != nullptr) terms.normal_force += coupling(terms, deflection);
  }

  /// The sideways deflection (m) that a contact keeps when it goes deeper from z0 to z1 > z0 >= 0 without moving
  /// sideways: less, for new area is anchored unstressed. The same in a file of another model.
  [[nodiscard, gnu::noinline]] Vec3 deepened(double z0, double z1, const Vec3& deflection) const {
    if (view_->coupled_laws == nullptr) return deflection;
    if (!(z0 > 0)) return {};
    const coupled::Vec2 u = law_.deepen(law_.abscissa(z0), law_.abscissa(z1), in_basis(deflection));
    return view_->meta->sideways_scale * (u.x * basis_x_ + u.y * basis_y_);
  }

  /// Force of a whole deflection p - c (m, body frame), sticking. Zero where its depth is not positive.
  [[nodiscard]] FieldForce force(const Vec3& deflection) const {
    DepthTerms terms = at_depth(-dot(deflection, normal_));
    couple(terms, deflection);
    FieldForce result;
    result.normal = terms.normal_force;
    result.limit = terms.limit;
    result.depth = terms.depth;
    result.beyond = terms.beyond;
    if (!(terms.depth > 0)) return result;
    result.tangential = terms.straight + sideways(terms, tangential(deflection, normal_));
    result.force = result.normal * normal_ + result.tangential;
    return result;
  }

private:
  /// One vertex of the body patch, its frame carried to c by the smallest rotation between the normals.
  struct Body {
    Vec3 x, y;
    double weight = 0;
    int corner = 0;
    int first_pair = 0;
  };
  struct Pair {
    const float* coefs = nullptr;  ///< gx, gy, phix, phiy, mu
    double weight = 0;
  };
  /// phi at x / X = r: inside [-1, 1] the spline, outside its tangent at the end.
  struct Along {
    spline::Basis basis;
    double extra;
    Along(int count, double r)
        : basis(spline::basis(count, 0.5 * (r + 1))),
          extra(r > 1    ? r - 1
                : r < -1 ? r + 1
                         : 0) {}
    [[nodiscard]] double value(const float* phi, int count) const {
      const double inside = spline::combine(basis, phi);
      if (extra == 0) return inside;
      return inside + 0.5 * extra * (extra > 0 ? spline::slope_at_1(phi, count) : spline::slope_at_0(phi, count));
    }
  };

  /// u of a deflection (m).
  [[nodiscard]] coupled::Vec2 in_basis(const Vec3& deflection) const {
    return {per_scale_ * dot(deflection, basis_x_), per_scale_ * dot(deflection, basis_y_)};
  }

  [[nodiscard, gnu::always_inline]] inline DepthTerms separable_at(double z) const {
    DepthTerms terms;
    if (!(z > 0)) return terms;
    const layout::Meta& m = *view_->meta;
    const double share = z / m.depth_scale;
    const double s = share < 1 ? std::sqrt(share) : 1.0;
    const double extra = share < 1 ? 0 : 0.5 * (share - 1);  // linear in z beyond Z: ds/dz = 1 / (2 Z) there
    terms.depth = z;
    terms.beyond = z > limit_ * kLimitSlack;
    // Curves of as many coefficients have one basis.
    spline::Basis basis = spline::basis(static_cast<int>(m.normal_coefs), s);
    std::uint32_t basis_of = m.normal_coefs;
    const auto choose = [&](std::uint32_t count) {
      if (count != basis_of) basis = spline::basis(static_cast<int>(count), s);
      basis_of = count;
    };
    const auto curve = [&](const auto* coefs) {
      const double inside = spline::combine(basis, coefs);
      return extra > 0 ? inside + extra * spline::slope_at_1(coefs, static_cast<int>(basis_of)) : inside;
    };
    terms.normal_force = curve(push_);
    if (m.lateral_coefs > 0) {
      choose(m.lateral_coefs);
      terms.straight = curve(lateral_x_) * basis_x_ + curve(lateral_y_) * basis_y_;
    }
    terms.limit = HUGE_VAL;
    if (m.friction_coefs == 0) return terms;
    choose(m.friction_coefs);
    terms.limit = spline::combine(basis, mu_) * terms.normal_force;
    choose(m.growth_coefs);
    for (int j = 0; j < pairs_; ++j) {
      for (std::uint32_t axis = 0; axis < 2; ++axis) {
        const double value = curve(pair_[j].coefs + axis * m.growth_coefs);
        terms.growth[j][axis] = value > 0 ? pair_[j].weight * value : 0;
      }
    }
    return terms;
  }

  // What only the coupled model needs stays out of line: inlined into a tick it would slow the others by a tenth.
  [[nodiscard, gnu::noinline]] Vec3 coupled_sideways(const DepthTerms& terms, const Vec3& deflection) const {
    if (!(terms.depth > 0)) return {};
    const coupled::Vec2 push = terms.coupled.energy.gradient(in_basis(deflection), law_.degrees().order);
    return -push.x * basis_x_ - push.y * basis_y_;
  }

  [[nodiscard, gnu::noinline]] double coupling(const DepthTerms& terms, const Vec3& deflection) const {
    return terms.depth > 0 ? law_.coupling(terms.coupled, in_basis(deflection)) : 0;
  }

  [[nodiscard, gnu::noinline]] DepthTerms coupled_at(double z) const {
    DepthTerms terms;
    if (!(z > 0)) return terms;
    terms.coupled = law_.at(law_.abscissa(z), false);
    terms.depth = z;
    terms.beyond = z > limit_ * kLimitSlack;
    terms.normal_force = terms.coupled.push;
    terms.limit = terms.coupled.limit * terms.coupled.push;
    terms.straight = -terms.coupled.straight.x * basis_x_ - terms.coupled.straight.y * basis_y_;
    return terms;
  }

  void add_bodies(const BodyPoint& at) {
    double weights[3];
    patch_weights(*view_, at, weights);
    const layout::Patch& patch = view_->patches[view_->triangles[at.triangle].patch];
    for (int k = 0; k < 3; ++k) {
      if (!(weights[k] > 0)) continue;
      Body& body = body_[bodies_++];
      body.weight = weights[k];
      body.corner = k;
      if ((view_->features & (layout::feature_lateral | layout::feature_friction)) == 0) continue;  // nothing sideways
      body.x = carried_tangent(view_->sites[patch.vertex[k]], normal_, basis_x_);
      body.y = cross(normal_, body.x);
    }
  }

  void add_pair(const Body& body, std::uint64_t index, double weight) {
    const layout::Meta& m = *view_->meta;
    const layout::ResponseHead& head = view_->response_head(index);
    limit_ += weight * head.depth_limit;
    if ((head.flags & layout::response_covered) != 0) covered_ += weight;
    if (view_->coupled_laws != nullptr) {
      law_.add(view_->coupled_coefs(index), static_cast<double>(view_->coupled_unit(index)), layout::kLimitUnit, weight,
               {dot(body.x, basis_x_), dot(body.x, basis_y_)});
      return;
    }
    const float* push = view_->normal_coefs(index);
    for (std::uint32_t k = 0; k < m.normal_coefs; ++k) push_[k] += weight * push[k];
    if (view_->lateral != nullptr) {
      const float *x = view_->lateral_coefs(index), *y = x + m.lateral_coefs;
      const double xx = weight * dot(body.x, basis_x_), xy = weight * dot(body.x, basis_y_);
      const double yx = weight * dot(body.y, basis_x_), yy = weight * dot(body.y, basis_y_);
      for (std::uint32_t k = 0; k < m.lateral_coefs; ++k) {
        lateral_x_[k] += xx * x[k] + yx * y[k];
        lateral_y_[k] += xy * x[k] + yy * y[k];
      }
    }
    if (view_->friction != nullptr) {
      const float* coefs = view_->friction_coefs(index);
      const float* mu = coefs + 2 * m.growth_coefs + 2 * m.sideways_coefs;
      for (std::uint32_t k = 0; k < m.friction_coefs; ++k) mu_[k] += weight * mu[k];
      pair_[pairs_++] = {coefs, weight};
    }
  }

  /// Limits are stored as floats: a push to just the sampled depth must not count as beyond it.
  static constexpr double kLimitSlack = 1 + 1e-5;

  const View* view_ = nullptr;
  Vec3 normal_, basis_x_, basis_y_;
  double per_scale_ = 0;  ///< 1 / X (1/m)
  double covered_ = 0, limit_ = 0;
  int bodies_ = 0, pairs_ = 0;
  Body body_[4];  // one past the last marks where its pairs end
  Pair pair_[9];
  double push_[layout::kMaxCoefs] = {};
  double lateral_x_[layout::kMaxCoefs] = {}, lateral_y_[layout::kMaxCoefs] = {};
  double mu_[layout::kMaxCoefs] = {};
  coupled::Law law_;
};

}  // namespace palpate::runtime
