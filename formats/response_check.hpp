// SPDX-License-Identifier: MIT
// What a response file's content must satisfy before it is written.
#pragma once

#include "formats/response.hpp"

namespace palpate::detail {

/// Throws Error(bad_input) that names the first element breaking the specification, and the allowed range.
void check_content(const ResponseFileContent& content);

/// Triangle across the edge opposite each corner. Throws Error(bad_input) unless the surface is closed,
/// manifold along edges and consistently oriented.
std::vector<std::array<std::uint32_t, 3>> neighbours(const ResponseFileContent& content);

}  // namespace palpate::detail
