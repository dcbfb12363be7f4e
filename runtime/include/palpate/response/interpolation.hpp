// SPDX-License-Identifier: MIT
// The responses around a contact (c, p), carried to c and blended into one law.
#pragma once

#include "palpate/geometry/surface.hpp"
#include "palpate/geometry/tool_shape.hpp"
#include "palpate/response/orientation.hpp"
#include "palpate/response/response_law.hpp"

namespace palpate::runtime {

/// The part of a file that a contact reads: the blend of the responses of three sites and up to three tool vertices. Fixed
/// size. Features that kFeatures leaves out must not be in the view.
template <std::uint32_t kFeatures = layout::feature_all>
class BlendedResponse {
  static constexpr bool kSpin = (kFeatures & layout::feature_spin) != 0;
  static constexpr bool kSoftening = (kFeatures & layout::feature_slip_softening) != 0;

public:
  /// Blends the responses at a point c of the body and a point p of the tool. `x`: a unit vector; its part across the
  /// smooth normal at c becomes the basis of the blend. `lies`: for tools that are sampled at several spins.
  void blend(const View& view, std::uint32_t tool, const BodyPoint& c, const ToolPoint& p, const Vec3& x,
             const Orientation& lies) {
    double weights[3];
    site_weights(view, c, weights);
    normal_ = smooth_normal(view, c, weights);
    x_ = unit(tangential(x, normal_), any_orthogonal(normal_));
    y_ = cross(normal_, x_);
    const response::Degrees degrees = response::degrees(*view.meta);
    const response::Offsets offsets = response::offsets(degrees);
    double sum[response::kMostCoefs];
    for (int k = 0; k < offsets.end; ++k) sum[k] = 0;
    depth_limit_ = filled_share_ = softening_ = 0;
    for_each_share<kFeatures>(view, tool, c, p, lies, *this, weights,
                              [&](std::uint64_t index, double share, const Vec2& axis) {
                                add(view, offsets, index, share, axis, sum);
                              });
    law_.set(degrees, sum, view.meta->depth_scale, view.meta->tangential_scale);
  }

  /// Adds a share of another response. Both are with respect to the contact's axis.
  void mix(const BlendedResponse& other, double share) {
    law_.mix(other.law_, share);
    depth_limit_ += share * (other.depth_limit_ - depth_limit_);
    filled_share_ += share * (other.filled_share_ - filled_share_);
    softening_ += share * (other.softening_ - softening_);
  }

  [[nodiscard]] const ResponseLaw& law() const { return law_; }
  /// Smooth unit normal at c, and the basis across it.
  [[nodiscard]] const Vec3& normal() const { return normal_; }
  [[nodiscard]] const Vec3& basis_x() const { return x_; }
  [[nodiscard]] const Vec3& basis_y() const { return y_; }
  /// m, how deep the blended responses were sampled.
  [[nodiscard]] double depth_limit() const { return depth_limit_; }
  /// Share [0, 1] of the blend that was filled from neighbouring sites.
  [[nodiscard]] double filled_share() const { return filled_share_; }
  /// Share [0, 0.2] of the normal force that is lost where the contact has slipped.
  [[nodiscard]] double softening() const { return kSoftening ? softening_ : 0; }

  [[nodiscard]] Vec2 in_plane(const Vec3& v) const { return {dot(v, x_), dot(v, y_)}; }
  [[nodiscard]] Vec3 in_space(const Vec2& v) const { return v.x * x_ + v.y * y_; }

  /// Force (N, body frame) on a sticking tool at the whole deflection p - c (m); zero where it is not pushed in.
  [[nodiscard]] Vec3 force(const Vec3& deflection) const {
    const double z = -dot(deflection, normal_);
    if (!(z > 0)) return {};
    const ResponseAtDepth r = law_.at(z);
    const Vec2 e = in_plane(deflection);
    const double normal = r.normal_force + dot(r.bias_slope, e) + 0.5 * quadratic(r.normal_coupling, e);
    return normal * normal_ - in_space(r.bias + r.stiffness * e);
  }

private:
  /// Adds a response's coefficients, with `axis` its x axis in the basis of the blend as a complex number: first
  /// harmonics are turned by it, second harmonics by its square.
  void add(const View& view, const response::Offsets& offsets, std::uint64_t index, double share, const Vec2& axis,
           double* sum) {
    const layout::ResponseHead& head = view.response_head(index);
    depth_limit_ += share * double{head.depth_limit};
    if (head.flags == layout::response_filled) filled_share_ += share;
    if (kSoftening && view.meta->softening_count > 0) softening_ += share * view.softening(index);
    double coefs[response::kMostCoefs];
    layout::unpack_coefficients(view.packed_coefficients(index), offsets, view.meta->coef_bits, coefs);
    const double factor = share * double{view.coefficient_unit(index)};
    const Vec2 first = factor * axis, second = factor * product(axis, axis);
    const auto harmonic = [&](int k, const Vec2& by) {
      sum[k] += coefs[k] * by.x - coefs[k + 1] * by.y;
      sum[k + 1] += coefs[k] * by.y + coefs[k + 1] * by.x;
    };
    int k = 0;
    for (; k < offsets.bias; ++k) sum[k] += factor * coefs[k];
    for (; k < offsets.stiffness; k += 2) harmonic(k, first);
    for (; k < offsets.friction; k += 3) {
      sum[k] += factor * coefs[k];
      harmonic(k + 1, second);
    }
    for (; k < offsets.end; ++k) sum[k] += share * layout::kFrictionUnit * coefs[k];
  }

  ResponseLaw law_;
  Vec3 normal_, x_, y_;
  double depth_limit_ = 0;   ///< m
  double filled_share_ = 0;  ///< [0, 1]
  double softening_ = 0;     ///< [0, 0.2]
};

}  // namespace palpate::runtime
