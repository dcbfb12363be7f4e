// SPDX-License-Identifier: GPL-3.0-or-later
// The evaluation of formats/response/response-file.md written apart from the runtime: de Casteljau, Rodrigues, every
// response alone in its own carried frame.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "tests/runtime/support.hpp"

namespace palpate::test {

/// One response of a file by the specification's formulas.
class PlainResponse {
public:
  PlainResponse(const ResponseFileContent& content, const Response& r) : content_(&content), response_(&r) {}

  /// F, g (2), K (3: m, hx, hy), A (3) and mu at s = sqrt(z / Z), continued beyond Z as step 5 says.
  struct At {
    double force = 0, bias[2] = {}, bias_slope[2] = {}, stiffness[3] = {}, coupling[3] = {}, friction = 0, s = 0;
  };

  [[nodiscard]] At at(double z) const {
    const response::Degrees& d = content_->degrees;
    const response::Offsets o = response::offsets(d);
    const double ratio = z / content_->depth_scale, s = ratio < 1 ? std::sqrt(ratio) : 1;
    const double further = ratio > 1 ? (ratio - 1) / 2 : 0;  // times the slope by s
    At r;
    r.s = s;
    r.force = value(0, 1, d.normal, 2, s) + further * slope(0, 1, d.normal, 2, s);
    for (int c = 0; d.bias > 0 && c < 2; ++c) {
      r.bias_slope[c] = slope(o.bias + c, 2, d.bias, 2, s);
      r.bias[c] = value(o.bias + c, 2, d.bias, 2, s) + further * r.bias_slope[c];
    }
    if (!d.friction_families) return r;
    for (int c = 0; c < 3; ++c) {
      const auto rate = [&](double t) { return value(o.stiffness + c, 3, d.stiffness, 0, t); };
      r.stiffness[c] = integral(rate, s) + further * rate(s);
      if (d.stiffness > 0) r.coupling[c] = value(o.coupling + c, 3, d.stiffness, 2, s);
    }
    r.friction = layout::kFrictionUnit / double{response_->unit} * value(o.friction, 1, d.friction, 0, s);
    return r;
  }

  /// Force (N) in the frame (x, y, n) at a depth > 0 and a tangential deflection (m).
  [[nodiscard]] Vec3 force(double z, double ex, double ey) const {
    const At r = at(z);
    const double x = content_->tangential_scale, ux = x > 0 ? ex / x : 0, uy = x > 0 ? ey / x : 0;
    const auto times = [](const double (&k)[3], double a, double b) {
      return std::array<double, 2>{(k[0] + k[1]) * a + k[2] * b, k[2] * a + (k[0] - k[1]) * b};
    };
    const auto push = times(r.stiffness, ux, uy), couples = times(r.coupling, ux, uy);
    const double coupling = x * (ux * couples[0] + uy * couples[1]) / 2;
    const double fn = r.force + (r.bias_slope[0] * ex + r.bias_slope[1] * ey + coupling) / (2 * r.s * content_->depth_scale);
    return {-(r.bias[0] + push[0]), -(r.bias[1] + push[1]), fn};
  }

private:
  [[nodiscard]] double coefficient(int first, int stride, int low, int i) const {
    if (i < low) return 0;
    return double{response_->unit} * response_->coefficients[static_cast<std::size_t>(first + stride * (i - low))];
  }
  /// De Casteljau's algorithm.
  [[nodiscard]] double value(int first, int stride, int degree, int low, double s) const {
    std::vector<double> b;
    for (int i = 0; i <= degree; ++i) b.push_back(coefficient(first, stride, low, i));
    for (int round = degree; round > 0; --round) {
      for (int i = 0; i < round; ++i) {
        const auto k = static_cast<std::size_t>(i);
        b[k] = (1 - s) * b[k] + s * b[k + 1];
      }
    }
    return b[0];
  }
  [[nodiscard]] double slope(int first, int stride, int degree, int low, double s) const {
    double sum = 0;
    for (int i = 0; i < degree; ++i) {
      const double step = coefficient(first, stride, low, i + 1) - coefficient(first, stride, low, i);
      sum += degree * step * response::binomial(degree - 1, i) * std::pow(s, i) * std::pow(1 - s, degree - 1 - i);
    }
    return sum;
  }
  /// From 0 to s, by Gauss' rule of 4 points, which is exact to degree 7.
  template <class Function>
  static double integral(const Function& f, double s) {
    constexpr double kAt[] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
    constexpr double kWeight[] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += 0.5 * s * kWeight[k] * f(0.5 * s * (1 + kAt[k]));
    return sum;
  }

  const ResponseFileContent* content_;
  const Response* response_;
};

/// Rodrigues' rotation of v by the smallest rotation from one unit vector to another.
inline Vec3 rotated(const Vec3& v, const Vec3& from, const Vec3& to) {
  const Vec3 axis = cross(from, to);
  const double sine = length(axis), cosine = dot(from, to);
  if (!(sine > 1e-14)) return v;
  const Vec3 k = (1 / sine) * axis;
  return cosine * v + sine * cross(k, v) + ((1 - cosine) * dot(k, v)) * k;
}

inline Vec3 vec(const Triple& t) { return {t[0], t[1], t[2]}; }

/// Steps 1 to 5 for a body point, weights of the tool's vertices and a deflection (m).
inline Vec3 plain_force(const ResponseFileContent& content, const runtime::BodyPoint& at,
                        const std::vector<double>& tool_weights, const Vec3& deflection) {
  const ResponseTriangle& t = content.surface_triangles[at.triangle];
  const auto& patch = content.patches[t.patch];
  double weights[3] = {0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = t.grid[k][0], b = t.grid[k][1], whole = content.subdivision;
    weights[0] += at.bary[k] * a / whole;
    weights[1] += at.bary[k] * b / whole;
    weights[2] += at.bary[k] * (whole - a - b) / whole;
  }
  Vec3 n;
  for (std::size_t i = 0; i < 3; ++i) n = n + weights[i] * vec(content.sites[patch[i]].normal);
  n = unit(n, n);
  const double z = -dot(deflection, n);
  if (!(z > 0)) return {};
  Vec3 force;
  for (std::size_t i = 0; i < 3; ++i) {
    const ResponseSite& site = content.sites[patch[i]];
    const Vec3 x = rotated(vec(site.tangent), vec(site.normal), n), y = cross(n, x);
    for (std::size_t l = 0; l < tool_weights.size(); ++l) {
      const PlainResponse r(content, content.responses[patch[i] * content.tool_vertex_count() + l]);
      const Vec3 f = r.force(z, dot(deflection, x), dot(deflection, y));
      force = force + weights[i] * tool_weights[l] * (f.x * x + f.y * y + f.z * n);
    }
  }
  return force;
}

}  // namespace palpate::test
