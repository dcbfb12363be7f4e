// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/left_out.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "formats/io/error.hpp"
#include "precompute/fit/laws/grasp_fit.hpp"
#include "precompute/verify/held_out/statistics.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/output.hpp"
#include "tools/inspect/inspect.hpp"
#include "tools/report/numbers.hpp"

namespace palpate::report {
namespace {

/// Bytes of a response with and without a feature, from the layout. A file without it is compared with degrees that are
/// usual for a coupled response.
double feature_bytes(const layout::Meta& m, layout::Feature feature) {
  constexpr std::uint32_t kUsualDegree = 3, kUsualBonded = fit::kGraspCoefs;
  layout::Meta with = m, without = m;
  if (feature == layout::feature_friction) {
    if (!(m.tangential_scale > 0))
      with.tangential_scale = 1, with.stiffness_degree = with.friction_degree = kUsualDegree;
    without.tangential_scale = 0;
  } else if (feature == layout::feature_tangential_bias) {
    if (m.bias_degree == 0) with.bias_degree = kUsualDegree;
    without.bias_degree = 0;
  } else if (feature == layout::feature_slip_softening) {
    with.softening_count = 1;
    without.softening_count = 0;
  } else if (feature == layout::feature_bonded) {
    return layout::bonded_size(m.bonded_coefs > 0 ? m.bonded_coefs : kUsualBonded);
  } else if (feature == layout::feature_bonded_torque) {
    return layout::torque_size(m.bonded_coefs > 0 ? m.bonded_coefs : kUsualBonded);
  } else {
    return 0;  // a section of its own, not a part of a response
  }
  return double(layout::response_size(with)) - double(layout::response_size(without));
}

double section_bytes(const runtime::View& view, layout::Section id) {
  for (std::uint32_t k = 0; k < view.header().section_count; ++k) {
    if (view.sections()[k].id == static_cast<std::uint32_t>(id)) return double(view.sections()[k].size);
  }
  return 0;
}

/// Bytes of the whole file that the feature takes or would take.
double file_bytes(const runtime::View& view, layout::Feature feature) {
  const layout::Meta& m = *view.meta;
  switch (feature) {
    case layout::feature_tool_patches:
      return section_bytes(view, layout::Section::tool_vertices) + section_bytes(view, layout::Section::tool_patches);
    case layout::feature_spin:
      return section_bytes(view, layout::Section::spins);
    case layout::feature_search: {
      const double there = section_bytes(view, layout::Section::search);
      // A binary tree whose leaves hold four triangles has half as many nodes as triangles.
      return there > 0 ? there : 0.5 * m.triangle_count * sizeof(layout::SearchNode);
    }
    default:
      return feature_bytes(m, feature) * m.response_count;
  }
}

/// Equilibria that the feature takes or would take over all planned pairs.
double feature_solves(const pipeline::Pipeline& p, layout::Feature feature) {
  const SamplingScene& s = p.scene.sampling;
  if (feature != layout::feature_friction) return 0;
  return double(p.plan.pairs.size()) * s.tangential_depths * s.tangential_directions * s.tangential_points;
}

/// The press of a file fitted without the feature, in ns. Throws Error where there is no such fit.
double tick_without(const CostInput& input, layout::Feature feature) {
  pipeline::Pipeline p = input.pipeline;
  FitSettings settings = pipeline::fit_settings(p);
  switch (feature) {
    case layout::feature_friction:
      settings.friction = false;
      break;
    case layout::feature_tangential_bias:
      settings.bias_threshold = std::numeric_limits<double>::max();
      break;
    case layout::feature_search:
      p.scene.response.search = ResponseScene::Search::none;
      break;
    case layout::feature_bonded:
      settings.grasps.clear();
      settings.turns.clear();
      break;
    case layout::feature_bonded_torque:
      settings.turns.clear();
      break;
    default:
      throw Error(ExitCode::bad_input, "only another bake is without it");
  }
  const pipeline::FittedFile file = pipeline::fit_file(p, input.journal, settings);
  const runtime::OpenResult opened = runtime::View::open(file.bytes.data(), file.bytes.size());
  if (!opened) throw Error(ExitCode::numerical, opened.error);
  if ((opened.view.features & feature) != 0) throw Error(ExitCode::numerical, "the fit keeps it");
  cli::TickBenchOptions timing;
  timing.contacts = input.contacts;
  return cli::bench_ticks(opened.view, timing).press.quantile(0.5);
}

std::string sentence(const char* format, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace

Json left_out(const CostInput& input, double tick_ns, const cli::Globals& globals) {
  const runtime::View& view = input.response.view();
  Json features = Json::array();
  for (const cli::FeatureName& f : cli::feature_names()) {
    const bool present = (view.features & f.bit) != 0;
    Json feature{{"name", f.name},
                 {"present", present},
                 {"without", f.without},
                 {"bytes_per_response", feature_bytes(*view.meta, f.bit)},
                 {"bytes", file_bytes(view, f.bit)},
                 {"solves", feature_solves(input.pipeline, f.bit)}};
    if (present && input.laws) {
      try {
        cli::note(globals, std::string("fitting without ") + f.name);
        feature["tick_ns"] = rounded(tick_ns - tick_without(input, f.bit));
      } catch (const Error& error) {
        feature["cause"] = error.what();
      }
    }
    features.push_back(feature);
  }
  return {{"features", features}, {"response_bytes", layout::response_size(*view.meta)}};
}

Json hints(const CostInput& input, const Json& organ, const Json& cost) {
  const Scene& scene = input.pipeline.scene;
  const double tolerance = scene.response.tolerance;
  Json list = Json::array();
  if (tolerance < kNoticeable / 2) {
    list.push_back(
        sentence("response.tolerance = %.3g is finer than the just noticeable difference (%.0f %%): %.2g would do.",
                 tolerance, 100 * kNoticeable, kNoticeable / 2));
  }
  const Json& own = cost["files"][0];
  const double measured = own.contains("error") ? own["error"]["p95"].get<double>() : 0;
  for (const Json& tool : organ["tools"]) {
    std::vector<double> errors;
    for (const Json& e : tool["error_neighbours"]) {
      if (e.is_number()) errors.push_back(e.get<double>());
    }
    if (errors.empty()) continue;
    const auto share =
        double(std::count_if(errors.begin(), errors.end(), [](double e) { return 4 * e < kNoticeable; })) /
        double(errors.size());
    list.push_back(
        sentence("Tool '%s': %.0f %% of the solved sites differ from their neighbours by less than the "
                 "just noticeable difference (%.0f %%).",
                 tool["name"].get_ref<const std::string&>().c_str(), 100 * share, 100 * kNoticeable));
  }
  if (measured > 0) {
    // The error between sites grows as the square of their distance.
    const double factor = std::sqrt(kNoticeable / measured), spacing = scene.sampling.spacing;
    list.push_back(
        sentence("At held-out contacts one force in twenty is off by more than %.1f %%. sampling.spacing = %.2g "
                 "instead of %.2g would bring that %s the just noticeable difference (%.0f %%), with %.2g times the "
                 "sites.",
                 100 * measured, factor * spacing, spacing, factor < 1 ? "down to" : "up to", 100 * kNoticeable,
                 1 / (factor * factor)));
  }
  return list;
}

}  // namespace palpate::report
