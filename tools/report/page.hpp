// SPDX-License-Identifier: GPL-3.0-or-later
// One self-contained HTML page: the bundled template with the numbers and the response files in it.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace palpate::report {

/// Whether the program contains the page.
bool has_page();

/// Throws Error(usage), which names what the build of the program lacked, where the program does not contain the page.
void require_page();

/// The page. `numbers` and each response file are compressed (zlib) and written as base64; the bytes of a response file
/// are sorted by their place in words of four first, which saves a tenth. Throws as require_page does.
std::string page(const nlohmann::ordered_json& numbers, const std::vector<std::span<const std::byte>>& responses);

}  // namespace palpate::report
