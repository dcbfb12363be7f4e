// SPDX-License-Identifier: MIT
// Whole text files in and out, with errors that name the file and the cause.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// Reads a regular file of at most `largest` bytes; `what` names it in messages ("scene", "motion").
/// Throws Error(io) when it cannot be read, Error(bad_input) when it is larger.
std::string read_file(const std::filesystem::path& path, const std::string& what, std::size_t largest);

/// Writes a file so that it appears whole or not at all: a temporary file beside it, flushed to the disk and
/// renamed. A symbolic link stays, the file behind it is written; a pipe or a device is written to as it is.
/// Throws Error(io) when the folder cannot be written to or the disk is full.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Creates a folder and those above it where they are missing. Throws Error(io) when that is refused.
void make_folder(const std::filesystem::path& path);

}  // namespace palpate
