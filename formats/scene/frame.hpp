// SPDX-License-Identifier: MIT
// The frame of coordinates in a patient.
#pragma once

namespace palpate {

/// Directions of the axes: x to the left and y to the back (lps), or x right and y to the front (ras); z to the head.
/// Files of most kinds state none.
enum class Frame { unstated, lps, ras };

}  // namespace palpate
