// SPDX-License-Identifier: GPL-3.0-or-later
// palpate report: one page of a baked scene to look at and poke, made from a JSON file of the same numbers.
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/report/files.hpp"
#include "tools/report/page.hpp"

namespace palpate::cli {
namespace {

struct ReportArguments {
  report::ReportInput input;
  report::ReportFiles files;
  bool quick = false;
};

}  // namespace

void add_report(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<ReportArguments>();
  report::ReportInput& input = options->input;
  report::ReportFiles& files = options->files;
  Command command(app, "report", "Writes a page about a baked scene: its organ to poke, errors, costs, stability");
  command.option("scene", input.scene, "Scene file (TOML) that was baked").required();
  command.option("--verify", input.verify, "Report of 'palpate verify SCENE': errors at contacts between the sites");
  command.option("--battery", input.battery, "Report of 'palpate verify --battery stiff': stability of extreme cases");
  command
      .option("--beside", input.beside,
              "Scene of the same organ baked with another spacing; compared at the contacts of --verify")
      .needs("--verify");
  command.option("--compare", input.compared, "Response file of another organ, shown beside this one");
  command.option("--run", input.run, "Motion (CSV) or recording of 'palpate drive' to play back");
  command.option("--tool", input.tool, "Tool of the run; default: the run's, or the first");
  command.option("--contacts", input.contacts, "Contacts that are timed, of each file")
      .check(whole_in(1, 10000))
      .shows_default();
  command.flag("--quick", options->quick, "Without other response laws, tolerances and costs of features");
  command.option("--page", files.page, "HTML file (default: NAME.report.html beside the response file)");
  command.option("--numbers", files.numbers, "JSON file (default: NAME.report.json beside the response file)");
  command.option("--work", files.work, "Work folder (default: NAME.work beside the scene)");
  command.option("-o,--output", files.response, "Response file (default: NAME.palp beside the scene)");
  command.runs([options, &globals] {
    options->input.laws = !options->quick;
    const report::WrittenReport written = write_report_files(options->input, options->files, globals);
    globals.json ? print_json(to_json(written)) : print(to_text(written));
    report::require_page();
  });
}

}  // namespace palpate::cli
