// SPDX-License-Identifier: GPL-3.0-or-later
// palpate report: one page of a baked scene to look at and poke, made from a JSON file of the same numbers.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/error.hpp"
#include "formats/file.hpp"
#include "formats/same_file.hpp"
#include "tools/command.hpp"
#include "tools/commands.hpp"
#include "tools/output.hpp"
#include "tools/report/page.hpp"
#include "tools/report/report.hpp"
#include "tools/verify_checks.hpp"

namespace palpate::cli {
namespace {

struct ReportArguments {
  report::ReportInput input;
  std::string work, response, page, numbers;
  bool quick = false;
};

/// NAME.report.html or .json beside the scene.
std::string beside(const pipeline::Pipeline& p, const char* extension) {
  return (p.paths.response.parent_path() / (p.paths.response.stem().string() + extension)).string();
}

void run_report(ReportArguments options, const Globals& globals) {
  options.input.laws = !options.quick;
  pipeline::Pipeline p = pipeline::prepare(options.input.scene, {options.work, options.response});
  if (options.numbers.empty()) options.numbers = beside(p, ".report.json");
  if (options.page.empty()) options.page = beside(p, ".report.html");
  check_reports(p, {options.numbers, options.page});
  refuse_same({options.numbers, options.page},
              {options.input.verify, options.input.battery, options.input.compared, options.input.run});
  check_writable(options.numbers);
  const std::string missing = report::missing_for_page();
  if (missing.empty()) check_writable(options.page);
  pipeline::find_pairs(p);
  check_baked(p);
  pipeline::write_manifest(p);
  const ResponseInput response(p.paths.response);
  check_same_plan(p, response.view());
  const nlohmann::ordered_json numbers = report::make_report(options.input, p, response, globals);
  write_report(options.numbers, numbers);
  std::string html;
  if (!missing.empty()) {
    warn("there is no page, only its numbers: this program was built without it: " + missing);
  } else {
    const auto bytes = [](const ResponseInput& file) {
      return std::span(reinterpret_cast<const std::byte*>(file.view().bytes), file.view().size);
    };
    std::vector<std::span<const std::byte>> responses{bytes(response)};
    std::unique_ptr<ResponseInput> compared;
    if (!options.input.compared.empty()) {
      compared = std::make_unique<ResponseInput>(options.input.compared);
      responses.push_back(bytes(*compared));
    }
    html = report::page(numbers, responses);
    write_file(options.page, html);
  }
  if (globals.json) {
    nlohmann::ordered_json result{{"numbers", options.numbers}};
    if (missing.empty()) result.update({{"page", options.page}, {"page_bytes", html.size()}});
    return print_json(result);
  }
  print(options.numbers + "\n" +
        (html.empty() ? "" : options.page + ", " + std::to_string(html.size()) + " bytes\n"));
}

}  // namespace

void add_report(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<ReportArguments>();
  report::ReportInput& input = options->input;
  Command command(app, "report", "Writes a page about a baked scene: its organ to poke, errors, costs, stability");
  command.option("scene", input.scene, "Scene file (TOML) that was baked").required();
  command.option("--verify", input.verify, "Report of 'palpate verify SCENE': errors at contacts between the sites");
  command.option("--battery", input.battery, "Report of 'palpate verify --battery stiff': stability of extreme cases");
  command.option("--beside", input.beside,
                 "Scene of the same organ baked with another spacing; compared at the contacts of --verify");
  command.option("--compare", input.compared, "Response file of another organ, shown beside this one");
  command.option("--run", input.run, "Motion (CSV) or recording of 'palpate drive' to play back");
  command.option("--tool", input.tool, "Tool of the run; default: the run's, or the first");
  command.option("--contacts", input.contacts, "Contacts that are timed, of each file")
      .check(whole_in(1, 10000))
      .shows_default();
  command.flag("--quick", options->quick, "Without other response laws, tolerances and costs of features");
  command.option("--page", options->page, "HTML file (default: NAME.report.html beside the response file)");
  command.option("--numbers", options->numbers, "JSON file (default: NAME.report.json beside the response file)");
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command.option("-o,--output", options->response, "Response file (default: NAME.palp beside the scene)");
  command.runs([options, &globals] { run_report(*options, globals); });
}

}  // namespace palpate::cli
