// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of verify before it solves for minutes, and the report that it writes after that.
#pragma once

#include "palpate/palpate.hpp"
#include "precompute/pipeline/pipeline.hpp"

#include <cstdio>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace palpate::cli {

/// Throws Error(bad_input) where the response file was not made from this plan. Needs plan().
void check_same_plan(const pipeline::Pipeline& pipeline, const runtime::View& view);

/// Results of the bake's own checks of its normal indentations on finer meshes.
struct MeshChecks {
  std::size_t compared = 0, uncompared = 0;  ///< pairs
  double median = 0.0, worst = 0.0;          ///< relative difference of the force, of the compared
  std::uint32_t worst_pair = 0;
  std::size_t samples = 0, within_estimate = 0;  ///< see PairCheck
};

/// Counts of the pairs to be solved.
struct PairCounts {
  std::size_t planned = 0, accepted = 0, refused = 0;
  MeshChecks checks;
};

/// The bake's estimate of the 95th percentile of normal force errors (provenance of the file); 0 without automatic
/// sampling.
double expected_error(const runtime::View& view);

/// From plan and journal. Throws as read_journal.
PairCounts count_pairs(const pipeline::Pipeline& pipeline);

nlohmann::ordered_json to_json(const MeshChecks& checks);
/// One line; empty where nothing was checked.
std::string to_text(const MeshChecks& checks);

/// Writes the report whole or not at all. Throws Error(io).
void write_report(const std::filesystem::path& file, const nlohmann::ordered_json& report);

/// The components.
nlohmann::ordered_json list(const Eigen::Vector3d& vector);
/// The components of each.
nlohmann::ordered_json list(const std::vector<Eigen::Vector3d>& vectors);

/// The text of printf, at most 255 bytes.
template <class... Values>
std::string printed(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace palpate::cli
