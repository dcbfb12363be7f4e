// SPDX-License-Identifier: GPL-3.0-or-later
// Counts every allocation of the executable that links it.
#pragma once

namespace palpate::test {

/// Calls of operator new since the start.
long allocations();

}  // namespace palpate::test
