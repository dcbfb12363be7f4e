// SPDX-License-Identifier: MIT
// Vectors and symmetric tensors of a tangent plane.
#pragma once

#include <cmath>

namespace palpate::runtime {

struct Vec2 {
  double x = 0, y = 0;
};

inline Vec2 operator+(const Vec2& a, const Vec2& b) { return {a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(const Vec2& a, const Vec2& b) { return {a.x - b.x, a.y - b.y}; }
inline Vec2 operator*(double s, const Vec2& a) { return {s * a.x, s * a.y}; }
inline double dot(const Vec2& a, const Vec2& b) { return a.x * b.x + a.y * b.y; }
inline double length(const Vec2& a) { return std::sqrt(dot(a, a)); }
/// Product as complex numbers: turns a by the angle of b.
inline Vec2 product(const Vec2& a, const Vec2& b) { return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x}; }

/// The symmetric tensor m I + [[x, y], [y, -x]]: mean m and second harmonic (x, y).
struct Sym2 {
  double m = 0, x = 0, y = 0;
};

inline Sym2 operator+(const Sym2& a, const Sym2& b) { return {a.m + b.m, a.x + b.x, a.y + b.y}; }
inline Sym2 operator-(const Sym2& a, const Sym2& b) { return {a.m - b.m, a.x - b.x, a.y - b.y}; }
inline Sym2 operator*(double s, const Sym2& a) { return {s * a.m, s * a.x, s * a.y}; }
inline Vec2 operator*(const Sym2& k, const Vec2& u) {
  return {(k.m + k.x) * u.x + k.y * u.y, k.y * u.x + (k.m - k.x) * u.y};
}
/// u . k u.
inline double quadratic(const Sym2& k, const Vec2& u) { return dot(u, k * u); }

/// k^-1 b for a positive k. If k resists along one line only (determinant below 1e-12 m^2, with k = 2 m v v) the part
/// of b on that line counts; zero where k is not positive.
inline Vec2 solve(const Sym2& k, const Vec2& b) {
  if (!(k.m > 0)) return {};
  const double determinant = k.m * k.m - k.x * k.x - k.y * k.y;
  if (!(determinant > 1e-12 * k.m * k.m)) return (1 / (4 * k.m * k.m)) * (k * b);
  return (1 / determinant) * Vec2{(k.m - k.x) * b.x - k.y * b.y, (k.m + k.x) * b.y - k.y * b.x};
}

}  // namespace palpate::runtime
