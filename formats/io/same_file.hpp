// SPDX-License-Identifier: MIT
// Results that would be written over what they are made of, or over each other.
#pragma once

#include <filesystem>
#include <vector>

namespace palpate {

/// Throws Error(usage), naming both, where one of `outputs` is one of `inputs` or another output under whatever name:
/// by a link, by another way to it, there already or not. Empty paths are none. A path that is no regular file, as a
/// pipe or /dev/null, loses nothing by being written to, and may be named twice.
void refuse_same(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs);

}  // namespace palpate
