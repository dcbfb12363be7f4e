// SPDX-License-Identifier: GPL-3.0-or-later
// One straight push over one site of a response file.
#pragma once

#include <cstdint>

#include "palpate/format/response_view.hpp"

namespace palpate::cli {

/// Force (N) on the tool, upright over the site, after a straight push to that depth (m, > 0).
double straight_press(const runtime::View& view, std::uint32_t tool, std::uint32_t site, double depth);

}  // namespace palpate::cli
