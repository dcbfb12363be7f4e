// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/bake/shard.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>

#include "formats/io/error.hpp"

namespace palpate::bake {

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool divided = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = divided ? std::from_chars(index.ptr + 1, end, shard.count) : index;
  if (!divided || count.ec != std::errc() || count.ptr != end || shard.index < 1 || shard.index > shard.count ||
      shard.count > kMostShards) {
    throw Error(ExitCode::usage, "--shard: '" + text + "' is no shard; allowed I/N, 1 <= I <= N <= " +
                                     std::to_string(kMostShards) + " (3/8: the third of eight)");
  }
  return shard;
}

JournalContent read_shards(const std::filesystem::path& folder, const Hash128& manifest) {
  JournalContent all;
  if (!std::filesystem::exists(folder)) return all;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".journal") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    JournalContent one = read_journal(file, manifest);
    all.records += one.records;
    all.torn_bytes += one.torn_bytes;
    for (auto& [pair, content] : one.pairs) {
      if (content.outcome) all.pairs.emplace(pair, std::move(content));
    }
  }
  return all;
}

PairSolver recorded_solver(const std::vector<PairPlan>& pairs, const JournalContent& content) {
  // Pairs of several roles share the number of a site, and hidden places have numbers of their own.
  std::map<std::array<std::uint32_t, 4>, const JournalPair*> by_name;
  const auto name = [](const PairPlan& p) {
    return std::array{static_cast<std::uint32_t>(p.role), p.site, p.tool, p.tool_vertex};
  };
  for (const auto& [pair, recorded] : content.pairs) {
    if (pair < pairs.size()) by_name.emplace(name(pairs[pair]), &recorded);
  }
  return [by_name, name](const PairPlan& plan, const solve::SampleSink& sink) {
    const JournalPair& recorded = *by_name.at(name(plan));
    PairResult result{*recorded.outcome, recorded.samples, recorded.check};
    for (const Sample& sample : result.samples) sink(sample);
    return result;
  };
}

}  // namespace palpate::bake
