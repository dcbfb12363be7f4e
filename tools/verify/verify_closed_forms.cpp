// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_closed_forms.hpp"

#include "formats/io/error.hpp"
#include "precompute/bake/parallel.hpp"
#include "precompute/verify/closed_forms.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/verify_checks.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Range {
  double least = 0.0, most = 0.0;
};

Range range_of(const std::vector<verify::LawValue>& values) {
  const auto less = [](const verify::LawValue& a, const verify::LawValue& b) { return a.over_law < b.over_law; };
  const auto [least, most] = std::minmax_element(values.begin(), values.end(), less);
  return {least->over_law, most->over_law};
}

std::string law_row(const verify::ClosedForm& form, const verify::LawCheck& c) {
  std::string text = "| " + form.name + " | " + form.statement;
  if (!c.cause.empty()) return text + " | refused: " + c.cause + " |\n";
  for (const auto* values : {&c.small, &c.large, &c.endless}) {
    const Range r = range_of(*values);
    char figures[64];
    std::snprintf(figures, sizeof figures, " | %.3f to %.3f", r.least, r.most);
    text += figures;
  }
  return text + (c.holds() ? " | yes |\n" : " | NO |\n");
}

Json values_json(const std::vector<verify::LawValue>& values) {
  Json json = Json::array();
  for (const verify::LawValue& v : values) json.push_back({{"over_law", v.over_law}, {"tolerance", v.tolerance}});
  return json;
}

Json law_json(const verify::ClosedForm& form, const verify::LawCheck& c) {
  return {{"law", form.name},
          {"statement", form.statement},
          {"sizes", {form.small, form.large}},
          {"cause", c.cause},
          {"small", values_json(c.small)},
          {"large", values_json(c.large)},
          {"endless", values_json(c.endless)},
          {"holds", c.holds()}};
}

}  // namespace

void run_closed_forms(const ClosedFormsCommand& command, const Globals& globals) {
  const std::vector<verify::ClosedForm> forms = verify::closed_forms();
  std::vector<verify::LawCheck> checks(forms.size());
  note(globals, "solving " + std::to_string(forms.size()) + " laws on bodies of two sizes");
  bake::parallel_for(forms.size(), static_cast<unsigned>(globals.threads),
                     [&](std::size_t k) { checks[k] = verify::check(forms[k]); });
  std::string text =
      "solved over law: least and most of its values on a small and on a large body, and on an endless one as these "
      "two "
      "predict it\n\n| law | | small | large | endless | holds |\n|---|---|---|---|---|---|\n";
  Json json = Json::array();
  for (std::size_t k = 0; k < forms.size(); ++k) {
    text += law_row(forms[k], checks[k]);
    json.push_back(law_json(forms[k], checks[k]));
  }
  if (!command.report.empty()) write_report(command.report, json);
  if (globals.json) {
    print_json(json);
  } else {
    print(text);
  }
  for (std::size_t k = 0; k < forms.size(); ++k) {
    const verify::LawCheck& c = checks[k];
    if (c.holds()) continue;
    const std::string why = c.cause.empty() ? "solved over law is " + std::to_string(c.worst().over_law) : c.cause;
    throw Error(ExitCode::tolerance, forms[k].name + ": " + why);
  }
}

}  // namespace palpate::cli
