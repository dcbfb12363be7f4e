// SPDX-License-Identifier: MIT
// The coefficients of a response: how many there are and in which order. formats/response/response-file.md says what
// they mean.
#pragma once

#include <cstdint>
#include <cstring>

namespace palpate::response {

inline constexpr int kMaxDegree = 6;

namespace detail {
struct Binomials {
  std::uint8_t at[kMaxDegree + 1][kMaxDegree + 1] = {};
};
constexpr Binomials make_binomials() {
  Binomials b;
  for (int n = 0; n <= kMaxDegree; ++n) {
    b.at[n][0] = 1;
    for (int k = 1; k <= n; ++k) b.at[n][k] = static_cast<std::uint8_t>(b.at[n - 1][k - 1] + b.at[n - 1][k]);
  }
  return b;
}
inline constexpr Binomials kBinomials = make_binomials();
}  // namespace detail

/// n over k. Both are in [0, kMaxDegree].
constexpr double binomial(int n, int k) { return detail::kBinomials.at[n][k]; }

/// Degrees in s = sqrt(z / Z) of the polynomials of a response. All responses of a file share them.
/// The polynomials are in Bernstein's basis. Those "from s^2" have two leading coefficients of 0, which are not stored.
struct Degrees {
  int normal = 5;            ///< F, normal force of a normal indentation, from s^2; [2, kMaxDegree]
  int bias = 0;              ///< g, its tangential force, 2 components, from s^2; 0 (absent) or [2, kMaxDegree]
  int stiffness = 3;         ///< K', 3 components, and A, 3 components from s^2; 0 (a spring) or [2, kMaxDegree]
  int friction = 3;          ///< mu; [0, kMaxDegree]
  bool friction_families = true;  ///< false: the response has F and g alone, and both degrees above are 0
};

constexpr bool operator==(const Degrees& a, const Degrees& b) {
  return a.normal == b.normal && a.bias == b.bias && a.stiffness == b.stiffness && a.friction == b.friction &&
         a.friction_families == b.friction_families;
}

/// Null, or the rule that the degrees break.
constexpr const char* broken_degree(const Degrees& d) {
  const auto inside = [](int value, int low) { return value >= low && value <= kMaxDegree; };
  if (!inside(d.normal, 2)) return "normal_degree must be 2 to 6";
  if (d.bias != 0 && !inside(d.bias, 2)) return "bias_degree must be 0 or 2 to 6";
  if (!d.friction_families) {
    return d.stiffness == 0 && d.friction == 0
               ? nullptr
               : "stiffness_degree and friction_degree must be 0 in a frictionless file";
  }
  if (d.stiffness != 0 && !inside(d.stiffness, 2)) return "stiffness_degree must be 0 or 2 to 6";
  return inside(d.friction, 0) ? nullptr : "friction_degree must be 0 to 6";
}

/// The linear spring: F grows like the depth, the tangential stiffness like its root (the radius of a contact).
inline constexpr Degrees kSpring{2, 0, 0, 0, true};

/// Coefficients of one component of a polynomial from s^2.
constexpr int from_square(int degree) { return degree < 2 ? 0 : degree - 1; }

/// Index of the first coefficient of each family after F. `end` is the number of coefficients of a response.
struct Offsets {
  int bias, stiffness, coupling, friction, end;
};
constexpr Offsets offsets(const Degrees& d) {
  Offsets o{};
  o.bias = from_square(d.normal);
  o.stiffness = o.bias + 2 * from_square(d.bias);
  o.coupling = o.stiffness + (d.friction_families ? 3 * (d.stiffness + 1) : 0);
  o.friction = o.coupling + (d.friction_families ? 3 * from_square(d.stiffness) : 0);
  o.end = o.friction + (d.friction_families ? d.friction + 1 : 0);
  return o;
}
constexpr int count(const Degrees& d) { return offsets(d).end; }

inline constexpr int kMostCoefs = count({kMaxDegree, kMaxDegree, kMaxDegree, kMaxDegree, true});

/// Share of the tangential bias that remains while a contact slips, at s = min(1, sqrt(z / Z)).
/// The friction limit mu F bounds the tangential force less this share of the bias. The rest of the bias is shear of the
/// sticking contact that was solved, and slip removes it. Solved pushes that slip in every direction beside a lump give
/// 0.28, 0.43, 0.62 and 0.75 at s = 1/4, 1/2, 3/4 and 1.
constexpr double slipping_bias_share(double s) { return 0.75 * s; }

/// Reads `count` signed integers of `bits` (8, 12 or 16) each, two's complement, lowest bits first, without gaps.
/// The byte before `from` must be readable.
template <class Number>
inline void unpack(const unsigned char* from, std::uint32_t bits, int count, Number* to) {
  if (bits == 16) {
    for (int k = 0; k < count; ++k) {
      std::int16_t number;
      std::memcpy(&number, from + 2 * k, sizeof number);
      to[k] = number;
    }
    return;
  }
  if (bits == 8) {
    for (int k = 0; k < count; ++k) to[k] = static_cast<signed char>(from[k]);
    return;
  }
  // Two integers are three bytes. A word that begins one byte before them holds both in its upper three bytes. A shift
  // to the top and an arithmetic shift back extend the sign.
  const auto word = [](const unsigned char* at) {
    std::uint32_t bytes;
    std::memcpy(&bytes, at, sizeof bytes);
    return bytes;
  };
  const auto top = [](std::uint32_t bits_at_top) {
    return static_cast<Number>(static_cast<std::int32_t>(bits_at_top) >> 20);
  };
  const auto two = [&](const unsigned char* at, Number* numbers) {
    const std::uint32_t bytes = word(at - 1);
    numbers[0] = top(bytes << 12);
    numbers[1] = top(bytes);
  };
  for (; count > 3; count -= 4, from += 6, to += 4) {
    two(from, to);
    two(from + 3, to + 2);
  }
  if (count > 1) {
    two(from, to);
    count -= 2, from += 3, to += 2;
  }
  if (count > 0) to[0] = top((from[0] | static_cast<std::uint32_t>(from[1]) << 8) << 20);
}

}  // namespace palpate::response
