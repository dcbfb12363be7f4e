// SPDX-License-Identifier: MIT
#include "formats/io/same_file.hpp"

#include "formats/io/error.hpp"

#include <system_error>

namespace palpate {

namespace {

namespace fs = std::filesystem;

/// True if two paths, neither empty, name the same file. A path without access is refused where it is opened.
bool same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  const fs::file_status status = fs::status(a, error);
  if (fs::exists(status)) return fs::is_regular_file(status) && fs::equivalent(a, b, error) && !error;
  // The whole paths: of a relative one whose first part is not there weakly_canonical leaves the folder out.
  const auto whole = [](const fs::path& path) {
    std::error_code unseen;
    return fs::weakly_canonical(fs::absolute(path), unseen);
  };
  const fs::path canonical = whole(a);
  return !canonical.empty() && canonical == whole(b);
}

}  // namespace

void refuse_same(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (const fs::path& input : inputs) {
      if (input.empty() || !same(outputs[i], input)) continue;
      throw Error(ExitCode::usage, outputs[i].string() + ": would be written over " + input.string() +
                                       ", which is read; give the result another name");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (outputs[k].empty() || !same(outputs[i], outputs[k])) continue;
      throw Error(ExitCode::usage, outputs[i].string() + ": would be written over " + outputs[k].string() +
                                       ", another result; give each its own name");
    }
  }
}

}  // namespace palpate
