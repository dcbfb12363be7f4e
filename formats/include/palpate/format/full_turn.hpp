// SPDX-License-Identifier: MIT
// The angle of a full turn.
#pragma once

namespace palpate {

inline constexpr double kFullTurn = 6.283185307179586;  ///< rad

}  // namespace palpate
