// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/report.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "precompute/fit/assemble.hpp"
#include "precompute/verify/held_out/recorded.hpp"
#include "tools/cli/output.hpp"
#include "tools/inspect/inspect.hpp"
#include "tools/report/cost.hpp"
#include "tools/report/left_out.hpp"
#include "tools/report/organ.hpp"
#include "tools/report/provenance.hpp"
#include "tools/report/run.hpp"
#include "tools/report/stability.hpp"

namespace palpate::report {
namespace {

using Json = nlohmann::ordered_json;

Json read_json(const std::string& file) {
  constexpr std::size_t kLargest = std::size_t{1} << 30U;
  Json json = Json::parse(read_file(file, "report", kLargest), nullptr, false);
  if (json.is_discarded()) throw Error(ExitCode::bad_input, file + ": is no JSON");
  return json;
}

/// Figures of verify's report that the page prints, its held-out contacts aside.
Json verify_figures(const std::string& file) {
  Json json = read_json(file);
  if (!json.contains("error")) {
    throw Error(ExitCode::bad_input, file + ": is no report of palpate verify SCENE --report FILE");
  }
  json.erase("held_out");
  return json;
}

std::string base_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

/// The command line that makes the report again.
std::string command_line(const ReportInput& input) {
  std::string line = "palpate report " + input.scene;
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) line += std::string(" ") + option + " " + value;
  };
  add("--verify", input.verify);
  add("--battery", input.battery);
  for (const std::string& scene : input.beside) add("--beside", scene);
  add("--compare", input.compared);
  add("--run", input.run);
  add("--tool", input.tool);
  if (input.contacts != ReportInput{}.contacts) add("--contacts", std::to_string(input.contacts));
  if (!input.laws) line += " --quick";
  return line;
}

/// The command line that makes the report of verify again, or would make one.
std::string verify_line(const ReportInput& input, const Json& verified, std::size_t contacts) {
  std::string line = "palpate verify " + input.scene;
  if (!verified.is_null()) {
    line += " --count " + std::to_string(contacts);
    if (verified.contains("seed")) line += " --seed " + verified["seed"].dump();
  }
  return line + " --report " + (input.verify.empty() ? "verify.json" : input.verify);
}

}  // namespace

Json make_report(const ReportInput& input, const pipeline::Pipeline& p, const cli::ResponseInput& response,
                 const cli::Globals& globals) {
  const runtime::View& view = response.view();
  const std::string file = p.paths.response.string();
  // A wrong input is found before the first fit.
  std::vector<verify::HeldOut> held_out =
      input.verify.empty() ? std::vector<verify::HeldOut>() : verify::read_recorded(input.verify);
  verify::compare_with_file(view, held_out, input.verify);
  const Json verified = input.verify.empty() ? Json() : verify_figures(input.verify);
  const Json battery =
      input.battery.empty() ? Json() : battery_stability(read_json(input.battery), input.battery, p.scene);
  Json compared, run;
  if (!input.compared.empty()) {
    const cli::ResponseInput other(input.compared);
    compared = organ_of_file(other.view());
    compared["file"] = base_name(input.compared);
    compared["command"] = "palpate compare " + file + " " + input.compared;
  }
  static_cast<void>(response.tool(input.tool));  // one that is not there is wrong without a run, too
  if (!input.run.empty()) run = played_run(input.run, response, input.tool);

  const JournalContent journal = pipeline::samples(p);
  cli::note(globals, "fitting the samples");
  const pipeline::FittedFile fitted = pipeline::fit_file(p, journal, pipeline::fit_settings(p));
  Json report{{"title", p.scene.name}, {"command", command_line(input)}};
  const std::filesystem::path folder = std::filesystem::absolute(p.scene.file).parent_path().filename();
  if (!folder.empty()) report["title"] = folder.string() + " / " + p.scene.name;

  Json organ = organ_of_file(view);
  add_bake(organ, view, p, journal, fitted.fitted.report);
  organ["command"] = "palpate export " + file + " --curves curves.csv";
  report["organ"] = organ;
  report["contents"] = cli::contents_of(view, base_name(file));
  report["contents"]["command"] = "palpate inspect " + file;
  report["curves"] = {{"command", "palpate build " + input.scene}, {"pairs", solved_curves(p, journal)}};
  const std::string verify_command = verify_line(input, verified, held_out.size());
  report["held_out"] = {{"command", verify_command}, {"places", held_out_places(held_out)}};
  report["held_out"]["figures"] = verified;

  const CostInput cost{p, journal, response, held_out, input.beside, input.contacts, input.laws};
  report["error_time"] = error_against_time(cost, globals);
  report["error_time"]["command"] = "palpate bench --models " + input.scene + "; palpate bench " + file + "; " +
                                    verify_command + "; palpate verify " + file + " --samples " +
                                    (input.verify.empty() ? "verify.json" : input.verify);

  Json& stability = report["stability"];
  stability["bake"] = bake_stability(p, journal);
  stability["bake"]["command"] = "palpate build " + input.scene + " --json";
  stability["battery"] = battery;
  stability["battery_command"] =
      "palpate verify --battery stiff --report " + (input.battery.empty() ? "battery.json" : input.battery);
  stability["devices"] = device_stability(view);
  stability["devices_command"] = "palpate verify " + file + " --device NAME";

  const ResponseFileContent content = fit::assemble_response(p.scene, p.tools, pipeline::contact_surface(p), p.plan,
                                                             p.manifest, fitted.fitted, p.sources);
  report["left_out"] = left_out(cost, content, globals);
  report["left_out"]["command"] = report["command"];
  report["hints"] = hints(cost, organ, report["error_time"]);
  if (!compared.is_null()) report["compared"] = compared;
  if (!run.is_null()) report["run"] = run;
  std::vector<std::filesystem::path> read;
  for (const std::string& used : {input.verify, input.battery, input.compared, input.run}) {
    if (!used.empty()) read.emplace_back(used);
  }
  read.insert(read.end(), input.beside.begin(), input.beside.end());
  report["provenance"] = provenance(p, view, read);
  report["provenance"]["command"] = report["command"];
  return report;
}

}  // namespace palpate::report
