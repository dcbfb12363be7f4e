// SPDX-License-Identifier: MIT
// Checks of a response file's content before it is written.
#pragma once

#include "formats/response/response.hpp"

namespace palpate::detail {

/// Checks what the encoded bytes cannot show: names that are cut, counts that do not fit. Throws Error(bad_input).
void check_content(const ResponseFileContent& content);

/// Opens what was encoded as every later command will. Throws Error with the reader's message: numerical where a
/// curve is at fault, else bad_input.
void check_bytes(const std::vector<std::byte>& bytes);

/// Triangle across the edge opposite each corner. Throws Error(bad_input) unless the surface is closed,
/// manifold along edges and consistently oriented.
std::vector<std::array<std::uint32_t, 3>> neighbours(const ResponseFileContent& content);

}  // namespace palpate::detail
