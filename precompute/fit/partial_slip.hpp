// SPDX-License-Identifier: GPL-3.0-or-later
// How a contact comes to slip: the rim that gives way before all of it does (palpate/rim.hpp).
#pragma once

namespace palpate::fit {

struct Rim {
  double share = 0.0;  ///< of the contact, (0, 1)
  double limit = 0.0;  ///< of what its share holds, in friction limits of the contact, (0, 1)
};

/// Nearest to T / (mu P) = 1 - (1 - x)^(3/2), x the sideways deflection over that of full slip (Mindlin 1949): within
/// 0.029 everywhere, where a contact that sticks as a whole is off by 0.19.
inline constexpr Rim kCattaneoMindlin{0.3738, 0.4140};

}  // namespace palpate::fit
