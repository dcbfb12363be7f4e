// SPDX-License-Identifier: GPL-3.0-or-later
// A response file for a command: read, validated, with errors that name the file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/format/open.hpp"
#include "tools/cli/large_pages.hpp"

namespace palpate::cli {

class ResponseInput {
public:
  /// Throws Error(io) when the file cannot be read, Error(bad_input) when it is not a valid response file.
  explicit ResponseInput(const std::filesystem::path& path);
  ResponseInput(const ResponseInput&) = delete;
  ResponseInput& operator=(const ResponseInput&) = delete;

  [[nodiscard]] const runtime::View& view() const { return view_; }
  /// Index of the tool of that name; the first one for an empty name. Throws Error(bad_input) that lists the names.
  [[nodiscard]] std::uint32_t tool(const std::string& name) const;

private:
  std::filesystem::path path_;
  std::vector<std::byte, LargePages<std::byte>> bytes_;
  runtime::View view_;
};

/// Bytes of one response, with those of its bonded contact.
double bytes_per_response(const runtime::View& view);

}  // namespace palpate::cli
