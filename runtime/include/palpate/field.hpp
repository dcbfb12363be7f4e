// SPDX-License-Identifier: MIT
// The responses at a body point and a tool point, blended once, then evaluated for any deflection.
#pragma once

#include "palpate/response/response_law.hpp"
#include "palpate/spin.hpp"

#include <cmath>

namespace palpate::runtime {

struct FieldForce {
  Vec3 force;            ///< N on the tool, body frame
  Vec3 tangential;       ///< N, its part across n(c), not limited by friction
  double normal = 0;     ///< N
  double limit = 0;      ///< N, mu F; infinite in a frictionless file
  double depth = 0;      ///< m
  bool beyond = false;   ///< deeper than the pair was sampled
};

/// Calls use(response, share, cosine, sine) for every response of a tool at a body point and a tool point, with its
/// share of the blend and the angle of its x axis from the basis' one, counted about the normal.
template <class Use>
void for_each_share(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point,
                    const Spin& spin, const Vec3& normal, const Vec3& basis_x, const Vec3& basis_y, const Use& use) {
  double sites[3];
  patch_weights(view, body_point, sites);
  const ToolCorners corners = tool_corners(view, tool, tool_point);
  const auto& site = view.triangles[body_point.triangle].site;
  Across axis[3];
  for (int k = 0; k < 3; ++k) axis[k] = carried_axis(view.sites[site[k]], normal, basis_x, basis_y);
  SpinStep step;
  const SpunSites spun(view, view.tools[tool], spin, normal, basis_x, basis_y, axis, step);
  for (int l = 0; l < corners.count; ++l) {
    spun.for_each(corners.vertex[l], [&](int k, std::uint32_t sample, double share, const Across& x) {
      const double all = sites[k] * corners.weight[l] * share;
      if (all > 0) use(layout::response_index(*view.meta, site[k], corners.vertex[l]) + sample, all, x.cosine, x.sine);
    });
  }
}

/// Fixed size, no allocation.
class Field {
public:
  Field(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point,
        const Spin& spin = {})
      : friction_(view.has(layout::feature_friction)), normal_(runtime::normal(view, body_point)),
        basis_x_(any_orthogonal(normal_)), basis_y_(cross(normal_, basis_x_)) {
    law_.clear(layout::degrees(*view.meta), view.meta->depth_scale, view.meta->tangential_scale);
    for_each_share(view, tool, body_point, tool_point, spin, normal_, basis_x_, basis_y_,
                   [&](std::uint64_t index, double share, double cosine, double sine) {
                     std::int16_t coefs[response::kMaxCoefficients];
                     view.coefficients(index, coefs);
                     law_.add(coefs, static_cast<double>(view.coefficient_unit(index)), layout::kFrictionUnit, share,
                              {cosine, sine});
                     const layout::ResponseHead& head = view.response_head(index);
                     limit_ += share * static_cast<double>(head.depth_limit);
                     if (head.flags == layout::response_filled) filled_ += share;
                     if (view.has(layout::feature_slip_softening)) softening_ += share * view.softening(index);
                   });
  }

  [[nodiscard]] const Vec3& normal() const { return normal_; }
  [[nodiscard]] const response::Law& law() const { return law_; }
  /// Share of the blend that was filled from neighbours, [0, 1].
  [[nodiscard]] double filled() const { return filled_; }
  /// Share of the normal force that is lost once all of the contact slips; 0 in a file without softening.
  [[nodiscard]] double softening() const { return softening_; }
  /// Depth to which the blended responses were sampled (m).
  [[nodiscard]] double depth_limit() const { return limit_; }

  /// Force of a whole deflection p - c (m, body frame) while the contact sticks. Zero where its depth is not positive.
  [[nodiscard]] FieldForce force(const Vec3& deflection) const {
    FieldForce result;
    const double depth = -dot(deflection, normal_);
    if (!(depth > 0)) return result;
    const response::AtDepth terms = law_.at(depth);
    const Vec2 e = in_plane(deflection);
    result.tangential = in_space(law_.tangential(terms, e));
    result.normal = law_.normal(terms, e);
    result.limit = friction_ ? terms.friction * terms.normal : HUGE_VAL;
    result.force = result.normal * normal_ + result.tangential;
    result.depth = depth;
    result.beyond = depth > limit_ * (1 + 1e-5);
    return result;
  }

  /// The tangential deflection (m, body frame) after the tool went from depth z0 to z1 > z0 without moving across n(c).
  [[nodiscard]] Vec3 deepened(double z0, double z1, const Vec3& deflection) const {
    if (!(z0 > 0)) return {};
    return in_space(response::Law::deepened(law_.at(z0), law_.at(z1), in_plane(deflection)));
  }

private:
  [[nodiscard]] Vec2 in_plane(const Vec3& v) const { return {dot(v, basis_x_), dot(v, basis_y_)}; }
  [[nodiscard]] Vec3 in_space(const Vec2& v) const { return v.x * basis_x_ + v.y * basis_y_; }

  bool friction_;
  Vec3 normal_, basis_x_, basis_y_;
  double filled_ = 0, limit_ = 0, softening_ = 0;
  response::Law law_;
};

}  // namespace palpate::runtime
