// SPDX-License-Identifier: GPL-3.0-or-later
// Sites in an order of which every beginning is spread over the body.
#pragma once

#include "precompute/compliance/linear_body.hpp"

#include <cstddef>
#include <vector>

namespace palpate::compliance {

/// The usable sites, each as far as possible from those before it.
std::vector<std::size_t> spread_out(const std::vector<LoadSite>& sites, const std::vector<char>& usable);

}  // namespace palpate::compliance
