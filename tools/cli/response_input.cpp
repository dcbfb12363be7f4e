// SPDX-License-Identifier: GPL-3.0-or-later
// Opens response files for the commands.
#include "tools/cli/response_input.hpp"

#include "formats/io/error.hpp"
#include "formats/response/response.hpp"

namespace palpate::cli {

ResponseInput::ResponseInput(const std::filesystem::path& path) : path_(path) {
  const std::vector<std::byte> read = read_bytes(path);
  bytes_.assign(read.begin(), read.end());
  const runtime::OpenResult opened = runtime::View::open(bytes_.data(), bytes_.size());
  if (!opened) {
    const char* const hint = path.extension() == ".toml" ? "; give the response file of this scene (.palp)" : "";
    throw Error(ExitCode::bad_input, path.string() + ": " + opened.error + hint);
  }
  view_ = opened.view;
}

std::uint32_t ResponseInput::tool(const std::string& name) const {
  if (name.empty()) return 0;
  const std::uint32_t index = view_.find_tool(name.c_str());
  if (index < view_.meta->tool_count) return index;
  std::string names;
  for (std::uint32_t i = 0; i < view_.meta->tool_count; ++i)
    names += (i > 0 ? ", " : "") + std::string(view_.tools[i].name);
  throw Error(ExitCode::bad_input, path_.string() + ": there is no tool '" + name + "'; it has " + names);
}

double bytes_per_response(const runtime::View& view) {
  const layout::Meta& m = *view.meta;
  const double bonded = view.bonded != nullptr ? layout::bonded_size(m.bonded_coefs) : 0;
  const double torque = view.bonded_torque != nullptr ? layout::torque_size(m.bonded_coefs) : 0;
  return bonded + torque + layout::response_size(m);
}

}  // namespace palpate::cli
