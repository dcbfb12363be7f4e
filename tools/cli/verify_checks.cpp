// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of what stands on the disk.
#include "tools/cli/verify_checks.hpp"

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/journal/journal.hpp"
#include "precompute/verify/held_out/statistics.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace palpate::cli {

namespace fs = std::filesystem;

void check_same_plan(const pipeline::Pipeline& p, const runtime::View& view) {
  const auto provenance =
      nlohmann::json::parse(view.provenance, view.provenance + view.provenance_size, nullptr, false);
  const auto at = nlohmann::json::json_pointer("/inputs/manifest");
  if (provenance.contains(at) && provenance[at] == to_hex(p.manifest)) return;
  throw Error(ExitCode::bad_input, p.paths.response.string() + ": was not made from the plan in " +
                                       p.paths.work.string() +
                                       " (scene, surfaces or tools have changed since); run palpate fit or build");
}

double expected_error(const runtime::View& view) {
  const auto provenance =
      nlohmann::json::parse(view.provenance, view.provenance + view.provenance_size, nullptr, false);
  return provenance.is_object() ? provenance.value(nlohmann::json::json_pointer("/sampling/expected_p95"), 0.0) : 0.0;
}

PairCounts count_pairs(const pipeline::Pipeline& p) {
  PairCounts counts;
  for (std::uint32_t k = 0; k < p.plan.pairs.size(); ++k) counts.planned += p.sources.solved(k) ? 1 : 0;
  if (!fs::exists(p.paths.samples)) return counts;
  MeshChecks& checks = counts.checks;
  std::vector<double> differences;
  for (const auto& [index, pair] : read_journal(p.paths.samples, p.manifest).pairs) {
    if (!pair.outcome || !p.sources.solved(index)) continue;
    ++(pair.outcome->accepted ? counts.accepted : counts.refused);
    if (!pair.check) continue;
    ++(pair.check->compared > 0 ? checks.compared : checks.uncompared);
    if (pair.check->compared == 0) continue;
    checks.samples += pair.check->compared;
    checks.within_estimate += pair.check->within_estimate;
    differences.push_back(pair.check->difference);
    if (differences.size() > 1 && differences.back() <= checks.worst) continue;
    checks.worst = differences.back();
    checks.worst_pair = index;
  }
  checks.median = verify::quantile(differences, 0.5);
  return counts;
}

nlohmann::ordered_json to_json(const MeshChecks& checks) {
  return {{"compared", checks.compared},
          {"uncompared", checks.uncompared},
          {"median", checks.median},
          {"worst", checks.worst},
          {"worst_pair", checks.worst_pair},
          {"samples", checks.samples},
          {"within_estimate", checks.within_estimate}};
}

std::string to_text(const MeshChecks& checks) {
  if (checks.compared + checks.uncompared == 0) return {};
  char text[256];
  std::snprintf(
      text, sizeof text,
      "finer mesh: %zu pairs compared (%zu could not be), force off by %.2f %% at the median, %.2f %% in pair "
      "%u; %zu of %zu samples within their error estimates\n",
      checks.compared, checks.uncompared, 100 * checks.median, 100 * checks.worst, checks.worst_pair,
      checks.within_estimate, checks.samples);
  return text;
}

void write_report(const fs::path& file, const nlohmann::ordered_json& report) {
  // Names may hold bytes that are not UTF-8: they are replaced, not refused.
  write_file(file, report.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

nlohmann::ordered_json list(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

nlohmann::ordered_json list(const std::vector<Eigen::Vector3d>& vectors) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Eigen::Vector3d& vector : vectors) json.push_back(list(vector));
  return json;
}

}  // namespace palpate::cli
