// SPDX-License-Identifier: GPL-3.0-or-later
// Output of commands: results on standard output, notes on standard error; checks that a file of results can be
// written.
#pragma once

#include "tools/cli/commands.hpp"

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace palpate::cli {

/// Prints a result as text on standard output. Throws Error(io) when it cannot be written (a full disk).
void print(const std::string& text);

/// Prints a result as one indented JSON document and a newline; numbers round-trip, NaN and infinity become null.
void print_json(const nlohmann::ordered_json& document);

/// Before the work for it: throws Error(io) where no file of that name could be written.
void check_writable(const std::filesystem::path& file);

/// A note for the user: one line on standard error, unless --quiet.
void note(const Globals& globals, const std::string& line);

/// "1 pair", "2 pairs"; `others`: the plural that no s makes.
std::string counted(std::size_t count, const char* one, const char* others = nullptr);

/// As a shell takes it for one word.
std::string shell_word(const std::string& text);

/// A warning: "palpate: warning: LINE" on standard error, even with --quiet.
void warn(const std::string& line);

}  // namespace palpate::cli
