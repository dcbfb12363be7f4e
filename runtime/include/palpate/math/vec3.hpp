// SPDX-License-Identifier: MIT
// Three-vectors (body or tool frame, SI units).
#pragma once

#include "palpate/config.hpp"

#include <cmath>

namespace palpate::runtime {

/// The larger and the smaller of two numbers that are no NaN. std::fmax is a library call on most platforms.
inline constexpr double larger(double a, double b) { return a > b ? a : b; }
inline constexpr double smaller(double a, double b) { return a < b ? a : b; }
inline constexpr double clamped(double a, double low, double high) { return a > low ? (a < high ? a : high) : low; }

struct Vec3 {
  double x = 0, y = 0, z = 0;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
/// True where all components are finite and the squared length does not overflow.
inline bool finite(const Vec3& a) { return std::isfinite(dot(a, a)); }
inline Vec3 to_vec(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

/// The part of `v` across the unit vector n.
inline Vec3 tangential(const Vec3& v, const Vec3& n) { return v - dot(v, n) * n; }

/// The unit vector along v; `fallback` where v is shorter than 1e-12. `v`: a length (m), a force (N), or without a
/// unit; unit_face_normal() takes areas.
inline Vec3 unit(const Vec3& v, const Vec3& fallback) {
  const double size = length(v);
  return size > 1e-12 ? (1.0 / size) * v : fallback;
}

/// A unit vector orthogonal to the unit vector n (Duff and others, JCGT 6(1), 2017).
inline Vec3 any_orthogonal(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z), a = n.x / (sign + n.z);
  return {1 - sign * n.x * a, -sign * n.y * a, -sign * n.x};
}

/// `v` turned by the smallest rotation that takes the unit vector `from` to the unit vector `to`; where they are
/// opposed no rotation is the smallest, and `v` is returned.
inline Vec3 turned(const Vec3& v, const Vec3& from, const Vec3& to) {
  const double cosine = dot(from, to);
  if (!(cosine > -0.999)) return v;
  const Vec3 axis = cross(from, to);
  return cosine * v + cross(axis, v) + (dot(axis, v) / (1 + cosine)) * axis;
}

}  // namespace palpate::runtime
