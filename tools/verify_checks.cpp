// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of what stands on the disk.
#include "tools/verify_checks.hpp"

#include "formats/error.hpp"
#include "formats/file.hpp"
#include "formats/journal.hpp"

#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

namespace palpate::cli {

namespace fs = std::filesystem;

void check_writable(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::error_code error;
  int cause = fs::is_directory(file, error) ? EISDIR : 0;
  if (cause == 0 && ::access(folder.c_str(), W_OK | X_OK) != 0) cause = errno;
  if (cause == 0 && !fs::is_directory(folder, error)) cause = ENOTDIR;
  if (cause != 0) throw Error(ExitCode::io, file.string() + ": cannot write the report: " + std::strerror(cause));
}

void check_baked(const pipeline::Pipeline& p) {
  if (fs::exists(p.paths.journal)) return;
  throw Error(ExitCode::io, p.paths.journal.string() + ": there is no journal; run palpate build first");
}

void check_same_plan(const pipeline::Pipeline& p, const runtime::View& view) {
  const auto provenance =
      nlohmann::json::parse(view.provenance, view.provenance + view.provenance_size, nullptr, false);
  const auto at = nlohmann::json::json_pointer("/inputs/manifest");
  if (provenance.contains(at) && provenance[at] == to_hex(p.manifest)) return;
  throw Error(ExitCode::bad_input, p.paths.response.string() + ": was not made from the plan in " +
                                       p.paths.work.string() +
                                       " (scene, surfaces or tools have changed since); run palpate fit or build");
}

PairCounts count_pairs(const pipeline::Pipeline& p) {
  PairCounts counts{p.plan.pairs.size(), 0, 0};
  for (const auto& [index, pair] : read_journal(p.paths.journal, p.manifest).pairs) {
    if (!pair.outcome) continue;
    ++(pair.outcome->accepted ? counts.accepted : counts.refused);
  }
  return counts;
}

void write_report(const fs::path& file, const nlohmann::ordered_json& report) {
  // Names may hold bytes that are not UTF-8: they are replaced, not refused.
  write_file(file, report.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace palpate::cli
