// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/bench_solver.hpp"

#include "tools/bench/tick_bench.hpp"
#include "tools/cli/contact_case.hpp"
#include "tools/cli/output.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

void run_solver_bench(const SolverBenchCommand& command, const Globals& globals) {
  const ContactCase c =
      command.scene.empty() ? block_contact(0.03, 0.005, 0.005, 0.3) : scene_contacts(command.scene, command.contacts);
  verify::SolverBenchOptions options;
  note(globals, "solving " + std::to_string(c.contacts.size()) + " contacts at " +
                    std::to_string(options.settings.size() + 1) + " mesh sizes on one thread");
  const std::vector<verify::SolverBenchRow> rows = verify::bench_solver(c.scene, c.body, c.tool, c.contacts, options);

  const solve::PairPath path = solve::bake_path(c.scene, c.contacts[0].depth);
  const std::size_t tangential =
      path.tangential_depths.size() * std::size_t(path.tangential_directions) * std::size_t(path.tangential_points);
  char line[256];
  std::snprintf(
      line, sizeof line,
      "%s\n%s; %zu contacts, one thread\na set: %zu points of the normal indentation, %zu tangential; errors against "
      "elements of %.2g contact radii\n\n",
      machine_name().c_str(), c.name.c_str(), c.contacts.size(), path.normal_depths.size(), tangential,
      options.reference.mesh_size);
  std::string text = line;
  text +=
      "| elements | growth | longest | nodes | s a set | sets an hour | force | tangential force | "
      "tangential stiffness | refused | peak MB |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n";
  Json json{{"machine", machine_name()}, {"case", c.name}, {"contacts", c.contacts.size()}, {"rows", Json::array()}};
  for (const verify::SolverBenchRow& row : rows) {
    const double per_hour = row.seconds > 0 ? 3600 / row.seconds : 0;
    char longest[32] = "as the scene says";
    if (row.setting.max_size > 0) std::snprintf(longest, sizeof longest, "%.3g of the diagonal", row.setting.max_size);
    std::snprintf(line, sizeof line,
                  "| %.2g a | %.2g | %s | %.0f | %.2f | %.0f | %.2f %% | %.2f %% | %.2f %% | %zu | %.0f |\n",
                  row.setting.mesh_size, row.setting.growth, longest, row.nodes, row.seconds, per_hour,
                  100 * row.difference.normal, 100 * row.difference.tangential, 100 * row.difference.stiffness,
                  row.refused, row.megabytes);
    text += line;
    json["rows"].push_back({{"mesh_size", row.setting.mesh_size},
                            {"growth", row.setting.growth},
                            {"max_size_over_diagonal", row.setting.max_size},
                            {"nodes", row.nodes},
                            {"seconds", row.seconds},
                            {"sets_per_hour", per_hour},
                            {"force_error", row.difference.normal},
                            {"tangential_error", row.difference.tangential},
                            {"stiffness_error", row.difference.stiffness},
                            {"refused", row.refused},
                            {"peak_megabytes", row.megabytes}});
  }
  if (globals.json) {
    print_json(json);
  } else {
    print(text);
  }
}

}  // namespace palpate::cli
