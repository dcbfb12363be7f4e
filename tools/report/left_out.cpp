// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/left_out.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "formats/io/error.hpp"
#include "precompute/verify/held_out/statistics.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/output.hpp"
#include "tools/inspect/features.hpp"
#include "tools/inspect/inspect.hpp"
#include "tools/report/numbers.hpp"

namespace palpate::report {
namespace {

double section_bytes(const runtime::View& view, layout::Section id) {
  for (std::uint32_t k = 0; k < view.header().section_count; ++k) {
    if (view.sections()[k].id == static_cast<std::uint32_t>(id)) return double(view.sections()[k].size);
  }
  return 0;
}

/// Bytes of the whole file that the feature takes or would take; null where another bake alone would have them.
Json file_bytes(const runtime::View& view, layout::Feature feature) {
  const layout::Meta& m = *view.meta;
  const auto used = [&](double bytes) { return view.has(feature) ? Json(bytes) : Json(); };
  switch (feature) {
    case layout::feature_tool_patches:
      return used(section_bytes(view, layout::Section::tool_vertices) +
                  section_bytes(view, layout::Section::tool_patches));
    case layout::feature_spin:
      return used(section_bytes(view, layout::Section::spins));
    case layout::feature_compliance:
      return used(section_bytes(view, layout::Section::compliance));
    case layout::feature_search: {
      const double there = section_bytes(view, layout::Section::search);
      // A binary tree whose leaves hold four triangles has half as many nodes as triangles.
      return there > 0 ? there : 0.5 * m.triangle_count * sizeof(layout::SearchNode);
    }
    default:
      return cli::feature_bytes(m, feature) * m.response_count;
  }
}

/// Why no two files show the time of the feature; null where two do.
const char* untimed(layout::Feature feature) {
  switch (feature) {
    case layout::feature_tool_patches:
      return "another tool has other responses: palpate bench times the file of its own bake";
    case layout::feature_spin:
      return "a spin has responses of its own: palpate bench times the file of another bake";
    case layout::feature_bonded:
    case layout::feature_bonded_torque:
      return "no tick of a contact evaluates it, only one of a bonded tool";
    case layout::feature_compliance:
      return "no tick of a single contact evaluates it: palpate bench times five contacts without (five) and with "
             "(joint)";
    default:
      return nullptr;
  }
}

cli::TickBench timed(const ResponseFileContent& content, const CostInput& input) {
  const std::vector<std::byte> bytes = encode(content);
  const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
  if (!opened) throw Error(ExitCode::numerical, opened.error);
  cli::TickBenchOptions timing;
  timing.contacts = input.contacts;
  return cli::bench_ticks(opened.view, timing);
}

/// {tick_ns, slide_ns}: two files of the same responses, one with the feature and one without, are timed.
Json feature_times(const ResponseFileContent& content, layout::Feature feature, const CostInput& input) {
  const ResponseFileContent with = cli::with_feature(content, feature);
  const cli::TickBench longer = timed(with, input), shorter = timed(cli::without_feature(with, feature), input);
  const auto difference = [](const cli::Times& a, const cli::Times& b) {
    return rounded(a.quantile(0.5) - b.quantile(0.5));
  };
  return {{"tick_ns", difference(longer.press, shorter.press)}, {"slide_ns", difference(longer.slide, shorter.slide)}};
}

std::string sentence(const char* format, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace

Json left_out(const CostInput& input, const ResponseFileContent& content, const cli::Globals& globals) {
  const runtime::View& view = input.response.view();
  Json features = Json::array();
  for (const cli::FeatureName& f : cli::feature_names()) {
    Json feature{{"name", f.name},
                 {"present", view.has(f.bit)},
                 {"without", f.without},
                 {"bytes_per_response", cli::feature_bytes(*view.meta, f.bit)},
                 {"bytes", file_bytes(view, f.bit)},
                 {"solves", nullptr}};
    if (const std::optional<double> solves = cli::feature_solves(input.pipeline, f.bit)) feature["solves"] = *solves;
    if (const char* const cause = untimed(f.bit); cause != nullptr) {
      feature["cause"] = cause;
    } else if (input.laws) {
      cli::note(globals, std::string("timing the file with and without ") + f.name);
      feature.update(feature_times(content, f.bit, input));
    } else {
      feature["cause"] = "--quick times no features";
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
