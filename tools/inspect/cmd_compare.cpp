// SPDX-License-Identifier: GPL-3.0-or-later
// palpate compare: how much stiffer one baked organ is than another, site by site, pressed straight in equally deep.
#include "formats/io/error.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/play/indentation_force.hpp"

#include "palpate/math/vec3.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;
using runtime::Vec3;

struct CompareArguments {
  std::string file, other, tool;
  double within = 0.001, depth = std::numeric_limits<double>::infinity();
};

struct Site {
  std::uint32_t number = 0;
  Vec3 position;
  double limit = 0.0;  // m, how deep it was sampled
};

// Sites whose response to the tool's first vertex was not filled from neighbours.
std::vector<Site> own_sites(const runtime::View& view, std::uint32_t tool) {
  std::vector<Site> sites;
  for (std::uint32_t k = 0; k < view.meta->site_count; ++k) {
    const auto& head = view.response_head(layout::response_index(*view.meta, k, view.tools[tool].first_vertex));
    if ((head.flags & layout::response_filled) != 0) continue;
    sites.push_back({k, runtime::vertex(view, k), head.depth_limit});
  }
  return sites;
}

struct Pair {
  Vec3 position;
  double depth = 0.0, force = 0.0, other = 0.0;  // m, N, N
  [[nodiscard]] double ratio() const { return force / other; }
};

std::vector<Pair> compare(const CompareArguments& options, const ResponseInput& file, const ResponseInput& other) {
  const std::uint32_t tool = file.tool(options.tool), other_tool = other.tool(options.tool);
  const std::vector<Site> candidates = own_sites(other.view(), other_tool);
  std::vector<Pair> pairs;
  for (const Site& site : own_sites(file.view(), tool)) {
    const Site* nearest = nullptr;
    double least = options.within;
    for (const Site& c : candidates) {
      const double away = runtime::length(c.position - site.position);
      if (away <= least) least = away, nearest = &c;
    }
    if (nearest == nullptr) continue;
    Pair pair{site.position, std::min({site.limit, nearest->limit, options.depth}), 0, 0};
    pair.force = indentation_force(file.view(), tool, site.number, pair.depth);
    pair.other = indentation_force(other.view(), other_tool, nearest->number, pair.depth);
    if (pair.force > 0 && pair.other > 0) pairs.push_back(pair);
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.ratio() < b.ratio(); });
  return pairs;
}

Json to_json(const Pair& p) {
  return {{"ratio", p.ratio()},
          {"position_m", {p.position.x, p.position.y, p.position.z}},
          {"depth_m", p.depth},
          {"force_N", p.force},
          {"other_force_N", p.other}};
}

std::string line(const char* name, const Pair& p) {
  char text[200];
  std::snprintf(text, sizeof text, "%-8s %6.3f  at (%.4f, %.4f, %.4f) m, %.2f mm deep: %.4g N against %.4g N\n", name,
                p.ratio(), p.position.x, p.position.y, p.position.z, 1e3 * p.depth, p.force, p.other);
  return text;
}

void run_compare(const CompareArguments& options, const Globals& globals) {
  const ResponseInput file(options.file), other(options.other);
  const std::vector<Pair> pairs = compare(options, file, other);
  if (pairs.empty()) {
    throw Error(ExitCode::bad_input,
                options.file + " and " + options.other + ": no sites with responses of their own within " +
                    std::to_string(options.within) + " m of each other; a larger --within finds more");
  }
  const Pair &least = pairs.front(), &median = pairs[pairs.size() / 2], &largest = pairs.back();
  if (globals.json) {
    print_json({{"file", options.file},
                {"other", options.other},
                {"sites", pairs.size()},
                {"largest", to_json(largest)},
                {"median", to_json(median)},
                {"least", to_json(least)}});
    return;
  }
  print("force over force at " + std::to_string(pairs.size()) + " sites where both have responses of their own\n" +
        line("largest", largest) + line("median", median) + line("least", least));
}

}  // namespace

void add_compare(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<CompareArguments>();
  Command command(app, "compare", "How much stiffer one response file is than another, at sites of the same place");
  command.option("file", options->file, "Response file").required();
  command.option("other", options->other, "Response file that it is set against").required();
  command.option("--tool", options->tool, "Name of the tool in both; left out: the first");
  command.option("--within", options->within, "Sites this close (m) are the same place")
      .check(number_in(0, 1))
      .shows_default();
  command.option("--depth", options->depth, "Deepest push (m); left out: as deep as both were sampled")
      .check(number_in(1e-6, 1));
  command.runs([options, &globals] { run_compare(*options, globals); });
}

}  // namespace palpate::cli
