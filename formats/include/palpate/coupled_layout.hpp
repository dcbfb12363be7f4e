// SPDX-License-Identifier: MIT
// The coefficients of a coupled response: how many there are and in which order; formats/response-file.md says what
// they mean.
#pragma once

#include <cstdint>
#include <cstring>

namespace palpate::coupled {

inline constexpr int kMaxDegree = 6;

namespace detail {
struct Binomials {
  double at[kMaxDegree + 1][kMaxDegree + 1] = {};
};
constexpr Binomials make_binomials() {
  Binomials b;
  for (int n = 0; n <= kMaxDegree; ++n) {
    b.at[n][0] = 1;
    for (int k = 1; k <= n; ++k) b.at[n][k] = b.at[n - 1][k - 1] + b.at[n - 1][k];
  }
  return b;
}
inline constexpr Binomials kBinomials = make_binomials();
}  // namespace detail

/// Of Bernstein's basis: n over k, both in [0, kMaxDegree].
constexpr double binomial(int n, int k) { return detail::kBinomials.at[n][k]; }

/// Degrees in s of the families of a coupled response, the same all over a file. Each family is in Bernstein's basis;
/// those that start like s^2 have their first two coefficients 0, and these are not stored.
struct Degrees {
  int order = 2;      ///< of the energy in the sideways deflection, [2, 4]
  int push = 5;       ///< F: straight push, [2, kMaxDegree]; from s^2
  int straight = 0;   ///< g: its sideways force, 2 harmonics' parts; 0: none, else [2, kMaxDegree]; from s^2
  int stiffness = 3;  ///< K', 3 parts (mean, second harmonic), and A, 3 parts from s^2; 0 (a spring) or [2, kMaxDegree]
  int cubic = 0;      ///< C', 4 parts (first and third harmonic), where order > 2; [0, stiffness]
  int quartic = 0;    ///< Q', 5 parts (mean, second and fourth harmonic), where order > 3; [0, stiffness]
  int limit = 3;      ///< mu, [0, kMaxDegree]
};

constexpr bool in_range(const Degrees& d) {
  const auto inside = [](int value, int low, int high) { return value >= low && value <= high; };
  return inside(d.order, 2, 4) && inside(d.push, 2, kMaxDegree) &&
         (d.straight == 0 || inside(d.straight, 2, kMaxDegree)) &&
         (d.stiffness == 0 || inside(d.stiffness, 2, kMaxDegree)) &&
         (d.order > 2 ? inside(d.cubic, 0, d.stiffness) : d.cubic == 0) &&
         (d.order > 3 ? inside(d.quartic, 0, d.stiffness) : d.quartic == 0) && inside(d.limit, 0, kMaxDegree);
}

/// A spring: its force grows with depth, its sideways stiffness with the root of depth, like that of a contact's
/// radius.
inline constexpr Degrees kSpring{2, 2, 0, 0, 0, 0, 0};

/// Coefficients of a family from s^2, times its parts.
constexpr int from_square(int degree) { return degree < 2 ? 0 : degree - 1; }

/// Where each family begins; `end` is the number of coefficients of a response.
struct Places {
  int straight, stiffness, coupling, cubic, quartic, limit, end;
};
constexpr Places places(const Degrees& d) {
  Places p{};
  p.straight = from_square(d.push);
  p.stiffness = p.straight + 2 * from_square(d.straight);
  p.coupling = p.stiffness + 3 * (d.stiffness + 1);
  p.cubic = p.coupling + 3 * from_square(d.stiffness);
  p.quartic = p.cubic + (d.order > 2 ? 4 * (d.cubic + 1) : 0);
  p.limit = p.quartic + (d.order > 3 ? 5 * (d.quartic + 1) : 0);
  p.end = p.limit + d.limit + 1;
  return p;
}
constexpr int count(const Degrees& d) { return places(d).end; }

/// `count` whole numbers of `bits` (8, 12 or 16) each, two's complement, the lowest bits first, without gaps. The byte
/// before them must be readable.
template <class Integer>
inline void unpack(const unsigned char* from, std::uint32_t bits, int count, Integer* to) {
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
  // Two are three bytes. Read with the byte before them they are moved to the top of a word and back, which brings the
  // sign.
  const auto word = [](const unsigned char* at) {
    std::uint32_t bytes;
    std::memcpy(&bytes, at, sizeof bytes);
    return bytes;
  };
  const auto top = [](std::uint32_t bits_at_top) {
    return static_cast<Integer>(static_cast<std::int32_t>(bits_at_top) >> 20);
  };
  const auto two = [&](const unsigned char* at, Integer* numbers) {
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

inline constexpr int kMostCoefs = count({4, kMaxDegree, kMaxDegree, kMaxDegree, kMaxDegree, kMaxDegree, kMaxDegree});

}  // namespace palpate::coupled
