// SPDX-License-Identifier: MIT
// The inequalities that make a coupled response passive, as a fit keeps them and a reader checks them.
#pragma once

#include "palpate/coupled_layout.hpp"

#include <cmath>

namespace palpate::coupled {

namespace detail {

/// A reader takes it some twenty times a response: std::hypot would be half of its time.
inline double length(double a, double b) { return std::sqrt(a * a + b * b); }

}  // namespace detail

/// Coefficient `index` of a family of `components` parts after its degree was raised from `from` to `to`.
template <class Scalar>
double raised(const Scalar* family, int components, int component, int from, int to, int index) {
  // c'[i] = sum over j of c[j] binomial(from, j) binomial(to - from, i - j) / binomial(to, i)
  const int first = index > to - from ? index - (to - from) : 0, last = index < from ? index : from;
  double sum = 0;
  for (int j = first; j <= last; ++j) {
    sum += binomial(from, j) * binomial(to - from, index - j) * static_cast<double>(family[j * components + component]);
  }
  return sum / binomial(to, index);
}

/// A harmonic of the cubic or quartic part, of one or two parts from `first` on in a family of `components`.
struct Harmonic {
  double factor;  ///< of its length in margin
  int place, components, first, parts, degree;
};

/// Those of a law, each for use(harmonic).
template <class Use>
void for_each_harmonic(const Degrees& d, const Use& use) {
  const Places p = places(d);
  if (d.order > 2) {
    use(Harmonic{6, p.cubic, 4, 0, 2, d.cubic});
    use(Harmonic{6, p.cubic, 4, 2, 2, d.cubic});
  }
  if (d.order > 3) {
    use(Harmonic{12, p.quartic, 5, 0, 1, d.quartic});
    use(Harmonic{12, p.quartic, 5, 1, 2, d.quartic});
    use(Harmonic{12, p.quartic, 5, 3, 2, d.quartic});
  }
}

/// What the smallest eigenvalue of K' +- A must reach at coefficient `index` of the stiffness for the cubic and quartic
/// parts: 6 (|h1| + |h3|) + 12 (|m| + |h2| + |h4|), which bounds their Hessians, and with that keeps V convex in
/// |u| <= 1 and a lift passive at every u.
template <class Scalar>
double margin(const Scalar* coefs, const Degrees& d, int index) {
  double sum = 0;
  for_each_harmonic(d, [&](const Harmonic& h) {
    const auto part = [&](int k) {
      return raised(coefs + h.place, h.components, h.first + k, h.degree, d.stiffness, index);
    };
    sum += h.factor * (h.parts > 1 ? detail::length(part(0), part(1)) : std::fabs(part(0)));
  });
  return sum;
}

/// Smallest eigenvalue of K' + sign A at coefficient `index`.
template <class Scalar>
double least_stiffness(const Scalar* coefs, const Degrees& d, int index, int sign) {
  const Places p = places(d);
  double k[3];
  for (int c = 0; c < 3; ++c) {
    k[c] = static_cast<double>(coefs[p.stiffness + 3 * index + c]);
    if (index >= 2) k[c] += sign * static_cast<double>(coefs[p.coupling + 3 * (index - 2) + c]);
  }
  return k[0] - detail::length(k[1], k[2]);
}

/// How far that is above its margin; negative: not passive.
template <class Scalar>
double passive_slack(const Scalar* coefs, const Degrees& d, int index, int sign) {
  return least_stiffness(coefs, d, index, sign) - margin(coefs, d, index);
}

/// Null, or what breaks the rules: F from zero and not decreasing, mu in [0, largest], K' +- A above their margins.
template <class Scalar>
const char* broken_rule(const Scalar* coefs, const Degrees& d, double largest_limit) {
  const Places p = places(d);
  double last = 0, scale = 0;
  for (int k = 0; k < p.straight; ++k) {
    const auto value = static_cast<double>(coefs[k]);
    if (!(value >= last)) return "the normal force must start at zero and not decrease";
    last = value;
  }
  for (int k = p.limit; k < p.end; ++k) {
    const auto value = static_cast<double>(coefs[k]);
    if (!(value >= 0 && value <= largest_limit)) return "the friction limit is out of 0 to 10";
  }
  for (int k = p.stiffness; k < p.limit; ++k) scale = std::fmax(scale, std::fabs(static_cast<double>(coefs[k])));
  for (int i = 0; i <= d.stiffness; ++i) {
    const double least = margin(coefs, d, i) - 1e-12 * scale;  // round-off of the square roots alone
    if (!(least_stiffness(coefs, d, i, 1) >= least) || !(least_stiffness(coefs, d, i, -1) >= least)) {
      return "stiffness and coupling break the inequalities that make it passive";
    }
  }
  return nullptr;
}

}  // namespace palpate::coupled
