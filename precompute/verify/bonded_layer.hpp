// SPDX-License-Identifier: GPL-3.0-or-later
// A paraboloid on a thin incompressible layer that is bonded to its bed: force over that of Hertz at the same depth.
#pragma once

namespace palpate::verify {

/// Series of Dimitriadis et al. (2002), equation 14 at nu 0.5; x = sqrt(R d) / h in (0, 1].
double bonded_layer_series(double x);

/// Exact at small strain: the Fredholm equation of Lebedev and Ufliand (1958), to 0.1 %; x as above.
double bonded_layer_exact(double x);

}  // namespace palpate::verify
