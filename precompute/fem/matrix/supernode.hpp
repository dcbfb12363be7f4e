// SPDX-License-Identifier: GPL-3.0-or-later
// Triangular solves with one supernode of a Cholesky factor, in single precision and wide registers.
#pragma once

#include <vector>

namespace palpate::fem {

/// Some neighbouring columns of a factor L that share their rows: a lower triangle on top of a panel, stored by
/// columns, `height` values each (what stands above the diagonal is not read).
struct Supernode {
  int first = 0;              ///< column of L
  int columns = 0;            ///< at least 1
  int height = 0;             ///< rows of triangle and panel
  const int* rows = nullptr;  ///< of the panel in L; height - columns, ascending
  const float* values = nullptr;
};

/// L y = y in place, supernodes in ascending order. `work` has room for the tallest supernode.
void solve_lower(const std::vector<Supernode>& factor, float* y, float* work);
/// L^T y = y in place.
void solve_upper(const std::vector<Supernode>& factor, float* y, float* work);

}  // namespace palpate::fem
