// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/stability.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/io/error.hpp"
#include "precompute/verify/battery/stiff_cells.hpp"
#include "precompute/verify/held_out/statistics.hpp"
#include "tools/cli/verify_checks.hpp"
#include "tools/report/numbers.hpp"
#ifdef PALPATE_DEVICES
#include "device/stability/safety.hpp"
#endif

namespace palpate::report {
namespace {

Json figures(const std::vector<double>& values) {
  return {{"count", values.size()},
          {"median", rounded(verify::quantile(values, 0.5))},
          {"p95", rounded(verify::quantile(values, 0.95))},
          {"worst", rounded(verify::quantile(values, 1))}};
}

/// The gate of a refusal: its text up to the first figure.
std::string gate_of(const std::string& cause) {
  const std::size_t end = cause.find_first_of("0123456789:");
  std::string gate = cause.substr(0, end);
  while (!gate.empty() && (gate.back() == ' ' || gate.back() == '(')) gate.pop_back();
  return gate.empty() ? cause : gate;
}

bool within_factor(double a, double b, double factor) {
  return a > 0 && b > 0 && std::abs(std::log(a / b)) <= std::log(factor) * (1 + 1e-9);
}

}  // namespace

Json bake_stability(const pipeline::Pipeline& p, const JournalContent& journal) {
  const cli::PairCounts counts = cli::count_pairs(p);
  std::map<std::string, int> causes;
  std::size_t shortened = 0, solves = 0;
  double jacobian = 1, penetration = 0;
  std::vector<double> iterations, estimates;
  for (const auto& [index, pair] : journal.pairs) {
    if (!pair.outcome) continue;
    solves += pair.outcome->normal_solves + pair.outcome->tangential_solves;
    if (!pair.outcome->accepted) {
      ++causes[gate_of(pair.outcome->cause)];
      continue;
    }
    shortened += pair.outcome->cause.empty() ? 0 : 1;
    const double depth = p.plan.pairs[index].depth;
    for (const Sample& s : pair.samples) {
      jacobian = std::min(jacobian, s.min_jacobian);
      penetration = std::max(penetration, s.penetration / depth);
      iterations.push_back(s.iterations);
      estimates.push_back(s.error_estimate);
    }
  }
  Json json{{"planned", counts.planned},
            {"accepted", counts.accepted},
            {"refused", counts.refused},
            {"shortened", shortened},
            {"solves", solves},
            {"smallest_jacobian", rounded(jacobian)},
            {"largest_penetration_of_depth", rounded(penetration)},
            {"iterations", figures(iterations)},
            {"error_estimate", figures(estimates)},
            {"finer_mesh", cli::to_json(counts.checks)},
            {"causes", Json::array()}};
  for (const auto& [cause, pairs] : causes) json["causes"].push_back({{"cause", cause}, {"pairs", pairs}});
  return json;
}

Json battery_stability(const Json& battery, const std::string& source, const Scene& scene) {
  if (!battery.is_object() || battery.value("battery", "") != "stiff" || !battery.contains("cells")) {
    throw Error(ExitCode::bad_input, source + ": is no report of palpate verify --battery stiff --report FILE");
  }
  std::map<std::pair<std::string, std::string>, verify::BatteryCell> known;
  for (verify::BatteryCell& cell : verify::stiff_cells())
    known.emplace(std::pair{cell.family, cell.name}, std::move(cell));
  const double tolerance = battery.value("tolerance", 0.05);
  const double young = small_strain_young(scene.material), ratio = scene.sampling.depth / scene.tools.at(0).radius;
  Json json{{"seed", battery.value("seed", 0)},
            {"machine", battery.value("machine", "")},
            {"tolerance", tolerance},
            {"all", battery.value("all", Json::object())},
            {"cells", Json::array()}};
  for (const Json& cell : battery["cells"]) {
    const auto at = known.find({cell.value("family", ""), cell.value("cell", "")});
    if (at == known.end()) {
      throw Error(ExitCode::bad_input, source + ": has a cell '" + cell.value("cell", "") +
                                           "' that this program's battery does not have; run the battery again");
    }
    const Scene& made = at->second.scene;
    const double radius = made.tools.at(0).radius, e = small_strain_young(made.material);
    const char* result = "refused";
    if (cell.value("converged", false)) {
      result = !cell.contains("difference")                   ? "converged"
               : cell["difference"].get<double>() > tolerance ? "wrong"
                                                              : "verified";
    }
    json["cells"].push_back(
        {{"family", at->second.family},
         {"cell", at->second.name},
         {"core", at->second.core},
         {"result", result},
         {"cause", cell.value("cause", "")},
         {"seconds", rounded(cell.value("seconds", 0.0))},
         {"young_Pa", rounded(e)},
         {"poisson", made.material.poisson},
         {"depth_over_radius", rounded(at->second.depth / radius)},
         {"near", within_factor(e, young, 10) && std::abs(made.material.poisson - scene.material.poisson) <= 0.05 &&
                      within_factor(at->second.depth / radius, ratio, 2)}});
  }
  return json;
}

Json device_stability([[maybe_unused]] const runtime::View& view) {
  Json devices = Json::array();
#ifdef PALPATE_DEVICES
  for (const device::SimKind& kind : device::sim_kinds()) {
    const device::Safety s = device::safety(view, kind.plant, {});
    devices.push_back({{"device", kind.kind.name},
                       {"stiffness_N_per_m", rounded(s.stiffness)},
                       {"any_hand_N_per_m", rounded(s.passive.least())},
                       {"onset_N_per_m", rounded(s.onset.stiffness)},
                       {"onset_Hz", rounded(s.onset.frequency)},
                       {"largest_scale", rounded(s.largest_scale)},
                       {"verdict", !s.settles()               ? "oscillates in a usual grip"
                                   : s.passive_for_any_hand() ? "safe in any hand"
                                                              : "settles in a usual grip, not in every hand"}});
  }
#endif
  return devices;
}

}  // namespace palpate::report
