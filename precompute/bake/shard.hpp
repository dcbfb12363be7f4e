// SPDX-License-Identifier: GPL-3.0-or-later
// Shards: parts of a bake that run in processes of their own, each with a journal of its own, and their merge.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "formats/journal/journal.hpp"
#include "precompute/bake/bake.hpp"

namespace palpate::bake {

/// Part `index` of `count` of a bake: every count-th pair of the plan, from pair index - 1.
struct Shard {
  std::uint32_t index = 1;  ///< 1 to count
  std::uint32_t count = 1;  ///< at least 1

  [[nodiscard]] bool holds(std::uint32_t pair) const { return pair % count == index - 1; }
  /// Name of its files: "3-of-8".
  [[nodiscard]] std::string name() const { return std::to_string(index) + "-of-" + std::to_string(count); }
};

/// Most shards of a bake.
constexpr std::uint32_t kMostShards = 100'000;

/// Reads "3/8". Throws Error(usage) with the value and what is allowed.
Shard parse_shard(const std::string& text);

/// The finished pairs of every shard's journal (*.journal) in `folder`. A pair that several journals hold is taken from
/// the first by name. Empty without a folder. Throws as read_journal does.
JournalContent read_shards(const std::filesystem::path& folder, const Hash128& manifest);

/// Gives each pair as a journal holds it: a bake by this solver copies the pairs, and compares what was there before.
/// The pair has to be finished in `content`, which must outlive the solver. `pairs` are those of the plan.
PairSolver recorded_solver(const std::vector<PairPlan>& pairs, const JournalContent& content);

}  // namespace palpate::bake
