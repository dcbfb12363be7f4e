// SPDX-License-Identifier: MIT
// The separable response of one contact: curves of the depth, and products of curves of depth and sideways deflection.
#pragma once

#include "palpate/depth_terms.hpp"
#include "palpate/pieces.hpp"
#include "palpate/view.hpp"

#include <cmath>

namespace palpate::runtime {

/// Blend of the separable responses of up to three body vertices and three tool vertices (Hayward and Mahvash 2004).
/// Push, straight sideways force and friction limit are blended once; sideways forces are products, each in the frame
/// of its body vertex, and are blended as forces. Not for several threads at once (pieces.hpp).
/// Of layout::Feature those that kFeatures leaves out take neither code nor memory.
template <std::uint32_t kFeatures>
class SeparableLaw {
  static constexpr bool kLateral = (kFeatures & layout::feature_lateral) != 0;
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;

public:
  /// Forgets all responses. The basis spans what lies across n(c).
  void clear(const layout::Meta& meta, const Vec3& basis_x, const Vec3& basis_y) {
    meta_ = &meta;
    basis_x_ = basis_x;
    basis_y_ = basis_y;
    per_depth_ = 1 / static_cast<double>(meta.depth_scale);
    per_sideways_ = meta.sideways_scale > 0 ? 1 / static_cast<double>(meta.sideways_scale) : 0;
    for (std::uint32_t k = 0; k < meta.normal_coefs; ++k) push_[k] = 0;
    bodies_ = pairs_ = 0;
    push_piece_.forget();
    if constexpr (kLateral) {
      for (std::uint32_t k = 0; k < 2 * meta.lateral_coefs; ++k) lateral_[k] = 0;
      lateral_pieces_.forget();
    }
    if constexpr (kFriction) {
      for (std::uint32_t k = 0; k < meta.friction_coefs; ++k) mu_[k] = 0;
      mu_piece_.forget();
    }
  }

  /// What is added from now on has its sideways curves along x (unit, across n(c)) and along n(c) x x.
  void begin_body(const Vec3& x) {
    body_[bodies_].cosine = dot(x, basis_x_);
    body_[bodies_].sine = dot(x, basis_y_);
    body_[bodies_].first_pair = pairs_;
    body_[++bodies_].first_pair = pairs_;
  }

  /// One response of the view, by its index.
  void add(const View& view, std::uint64_t index, double weight) {
    const layout::Meta& m = *meta_;
    const Body& body = body_[bodies_ - 1];
    const float* push = view.normal_coefs(index);
    for (std::uint32_t k = 0; k < m.normal_coefs; ++k) push_[k] += weight * push[k];
    if constexpr (kLateral) {
      if (view.lateral != nullptr) add_lateral(view.lateral_coefs(index), weight * body.cosine, weight * body.sine);
    }
    if constexpr (kFriction) {
      if (view.friction != nullptr) add_friction(view.friction_coefs(index), weight);
    }
  }

  /// Forces, limit and growths at depth z > 0 (m).
  void at_depth(double z, DepthTerms& terms) const {
    const layout::Meta& m = *meta_;
    const double share = z * per_depth_;
    const double s = share < 1 ? std::sqrt(share) : 1.0;
    const double extra = share < 1 ? 0 : 0.5 * (share - 1);  // linear in z beyond Z: ds/dz = 1 / (2 Z) there
    terms.normal_force = one(push_piece_, push_, m.normal_coefs, s);
    if (extra > 0) terms.normal_force += extra * spline::slope_at_1(push_, static_cast<int>(m.normal_coefs));
    if constexpr (kLateral) {
      if (m.lateral_coefs > 0) {
        double straight[2];
        both(lateral_pieces_, lateral_, m.lateral_coefs, s, extra, straight);
        terms.straight = straight[0] * basis_x_ + straight[1] * basis_y_;
      }
    }
    terms.limit = HUGE_VAL;
    if constexpr (kFriction) {
      if (m.friction_coefs == 0) return;
      terms.limit = one(mu_piece_, mu_, m.friction_coefs, s) * terms.normal_force;
      for (int j = 0; j < pairs_; ++j) {
        double growth[2];
        both(pair_[j].growth, pair_[j].coefs, m.growth_coefs, s, extra, growth);
        for (int axis = 0; axis < 2; ++axis) {
          terms.growth[j][axis] = pair_[j].weight * (growth[axis] > 0 ? growth[axis] : 0);
        }
      }
    }
  }

  /// Sideways force (N, body frame) at terms of a positive depth and a deflection (m), without that of the straight
  /// push.
  [[nodiscard]] Vec3 sideways(const DepthTerms& terms, const Vec3& deflection) const {
    if constexpr (kFriction) {
      if (meta_->sideways_coefs > 0) return sum_sideways(terms, deflection);
    }
    return {};
  }

private:
  void add_lateral(const float* x, double cosine, double sine) {
    const std::uint32_t count = meta_->lateral_coefs;
    const float* y = x + count;
    for (std::uint32_t k = 0; k < count; ++k) {
      lateral_[k] += cosine * x[k] - sine * y[k];
      lateral_[count + k] += sine * x[k] + cosine * y[k];
    }
  }

  void add_friction(const float* coefs, double weight) {
    const layout::Meta& m = *meta_;
    Pair& pair = pair_[pairs_++];
    pair.coefs = coefs;
    pair.weight = weight;
    pair.growth.forget();
    pair.phi.forget();
    const float* mu = pair.coefs + 2 * m.growth_coefs + 2 * m.sideways_coefs;
    for (std::uint32_t k = 0; k < m.friction_coefs; ++k) mu_[k] += weight * mu[k];
    body_[bodies_].first_pair = pairs_;
  }

  [[nodiscard]] Vec3 sum_sideways(const DepthTerms& terms, const Vec3& deflection) const {
    const layout::Meta& m = *meta_;
    const int count = static_cast<int>(m.sideways_coefs);
    const double x = per_sideways_ * dot(deflection, basis_x_), y = per_sideways_ * dot(deflection, basis_y_);
    double force_x = 0, force_y = 0;
    for (int i = 0; i < bodies_; ++i) {
      const Body& body = body_[i];
      const Along along(count, body.cosine * x + body.sine * y, body.cosine * y - body.sine * x);
      double fx = 0, fy = 0;
      for (int j = body.first_pair; j < body_[i + 1].first_pair; ++j) {
        double phi[2];
        along.values(pair_[j].phi, pair_[j].coefs + 2 * m.growth_coefs, count, phi);
        fx += terms.growth[j][0] * phi[0];
        fy += terms.growth[j][1] * phi[1];
      }
      force_x += body.cosine * fx - body.sine * fy;
      force_y += body.sine * fx + body.cosine * fy;
    }
    return force_x * basis_x_ + force_y * basis_y_;
  }

  /// One body vertex, its frame carried to c: turned by this angle against the basis. Its pairs end where the next
  /// one's begin.
  struct Body {
    double cosine = 1, sine = 0;
    int first_pair = 0;
  };
  struct Pair {
    const float* coefs = nullptr;  ///< gx, gy, phix, phiy, mu
    double weight = 0;
    Pieces<2> growth, phi;
  };

  /// phi at x / X = r and y / X: inside [-1, 1] the splines, outside their tangents at the ends.
  struct Along {
    double r[2], t[2];
    bool outside;
    Along(int count, double x, double y) : r{x, y}, outside(false) {
      for (int axis = 0; axis < 2; ++axis) {
        const double above = r[axis] > -1 ? r[axis] : -1.0;  // a NaN lands at -1
        const double inside = above < 1 ? above : 1.0;
        t[axis] = 0.5 * (inside + 1) * (count - 3);
        outside = outside || r[axis] != inside;
      }
    }
    void values(const Pieces<2>& pieces, const float* phi, int count, double (&value)[2]) const {
      pieces.values(phi, count, t, value);
      if (outside) go_on(phi, count, value);
    }
    [[gnu::noinline]] void go_on(const float* phi, int count, double (&value)[2]) const {
      for (int axis = 0; axis < 2; ++axis, phi += count) {
        if (r[axis] > 1) value[axis] += 0.5 * (r[axis] - 1) * spline::slope_at_1(phi, count);
        if (r[axis] < -1) value[axis] += 0.5 * (r[axis] + 1) * spline::slope_at_0(phi, count);
      }
    }
  };

  static double one(const Pieces<1>& piece, const double* coefs, std::uint32_t coef_count, double s) {
    const int count = static_cast<int>(coef_count);
    double value[1];
    piece.values(coefs, count, {s * (count - 3)}, value);
    return value[0];
  }

  template <class Scalar>
  static void both(const Pieces<2>& pieces, const Scalar* coefs, std::uint32_t coef_count, double s, double extra,
                   double (&value)[2]) {
    const int count = static_cast<int>(coef_count);
    const double t = s * (count - 3);
    pieces.values(coefs, count, {t, t}, value);
    if (extra > 0) go_on(extra, coefs, count, value);
  }

  // Out of line, or it would be computed first and dropped.
  template <class Scalar>
  [[gnu::noinline]] static void go_on(double extra, const Scalar* coefs, int count, double (&value)[2]) {
    for (int axis = 0; axis < 2; ++axis) value[axis] += extra * spline::slope_at_1(coefs + axis * count, count);
  }

  const layout::Meta* meta_ = nullptr;
  Vec3 basis_x_, basis_y_;
  double per_depth_ = 0, per_sideways_ = 0;  ///< 1 / Z, 1 / X (1/m)
  int bodies_ = 0, pairs_ = 0;
  Body body_[4];
  detail::If<kFriction, Pair[9]> pair_;
  double push_[layout::kMaxCoefs] = {};
  detail::If<kLateral, double[2 * layout::kMaxCoefs]> lateral_ = {};  ///< along basis_x_, then along basis_y_
  detail::If<kFriction, double[layout::kMaxCoefs]> mu_ = {};
  Pieces<1> push_piece_;
  detail::If<kFriction, Pieces<1>> mu_piece_;
  detail::If<kLateral, Pieces<2>> lateral_pieces_;
};

}  // namespace palpate::runtime
