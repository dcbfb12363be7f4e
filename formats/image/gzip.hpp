// SPDX-License-Identifier: MIT
// Whether compressed data are whole.
#pragma once

#include <cstddef>
#include <filesystem>

namespace palpate::detail {

/// Bytes of the file from `offset` on; of gzip data there (several members count together), and of a zlib stream where
/// `zlib` says so, the bytes that they expand to. Expands little more than `enough` bytes: a file of megabytes may
/// expand to terabytes. Throws Error(bad_input) naming the file where compressed data are
/// damaged or have no end, Error(io) where it cannot be read.
std::size_t whole_size(const std::filesystem::path& file, std::size_t offset, bool zlib, std::size_t enough);

}  // namespace palpate::detail
