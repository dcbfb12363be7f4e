// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms of contact: what the entry point of the bake answers, over the law, on bodies of two sizes. A law is of
// an endless body; what a body's size takes part in falls with 1 / size, so that two sizes say how large it is.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace palpate::verify {

/// One figure over the law's.
struct LawValue {
  double over_law = 0.0;
  double tolerance = 0.0;  ///< how far from 1 it may be
};

/// The values from a body of one size.
struct LawValues {
  std::vector<LawValue> values;
  std::string cause;  ///< why there are none; empty: usable
};

struct ClosedForm {
  std::string name;                 ///< "Hertz"
  std::string statement;            ///< the law, and the case that is solved
  double small = 0.0, large = 0.0;  ///< sizes of the body: contact radii, of a layer thicknesses
  /// `coarser` (>= 1) multiplies the elements' size.
  std::function<LawValues(double size, double coarser)> solve;
};

/// Hertz (1882); Sneddon's (1965) flat punch and cone; Dimitriadis et al. (2002) on a bonded layer, and the exact
/// contact of linear elasticity there; Mindlin (1949); Cattaneo (1938) and Mindlin with full slip.
std::vector<ClosedForm> closed_forms();

struct LawCheck {
  std::string cause;                            ///< empty: usable
  std::vector<LawValue> small, large, endless;  ///< endless: extrapolated from both sizes
  /// Solved, and the larger and the endless body's values are within their tolerances; the sizes differ by no more.
  [[nodiscard]] bool holds() const;
  /// The value farthest from 1, counted in tolerances, of all on the larger and on the endless body.
  [[nodiscard]] LawValue worst() const;
};

/// Solves the law on both sizes.
LawCheck check(const ClosedForm& form);

}  // namespace palpate::verify
