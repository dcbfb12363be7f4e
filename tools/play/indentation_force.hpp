// SPDX-License-Identifier: GPL-3.0-or-later
// One normal indentation at one site of a response file.
#pragma once

#include <cstdint>

#include "palpate/format/response_view.hpp"

namespace palpate::cli {

/// Force (N) on the tool after a normal indentation at the site to that depth (m, > 0). The tool touches with the first
/// vertex of its first patch.
double indentation_force(const runtime::View& view, std::uint32_t tool, std::uint32_t site, double depth);

}  // namespace palpate::cli
