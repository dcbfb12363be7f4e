// SPDX-License-Identifier: GPL-3.0-or-later
// A slab of 60 x 60 x 20 mm on z = 0, as the text of an OFF file (m).
#pragma once

namespace palpate::test {

inline constexpr const char* kSlabOff =
    "OFF\n8 12 0\n"
    "-.03 -.03 0\n.03 -.03 0\n-.03 .03 0\n.03 .03 0\n"
    "-.03 -.03 .02\n.03 -.03 .02\n-.03 .03 .02\n.03 .03 .02\n"
    "3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n"
    "3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n3 1 3 5\n3 3 7 5\n";

}  // namespace palpate::test
