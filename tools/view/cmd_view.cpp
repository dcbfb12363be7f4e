// SPDX-License-Identifier: GPL-3.0-or-later
// palpate view: the page of a response file on localhost, with a run played back in it, also while it is recorded.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/inspect/inspect.hpp"
#include "tools/report/organ.hpp"
#include "tools/report/page.hpp"
#include "tools/report/run.hpp"
#include "tools/view/page_server.hpp"

namespace palpate::cli {
namespace {

struct ViewArguments {
  std::string file, run, report, tool;
  int port = 8050;
};

/// The numbers of a report, or those of the response file alone.
nlohmann::ordered_json numbers_of(const ViewArguments& options, const ResponseInput& input) {
  if (!options.report.empty()) {
    constexpr std::size_t kLargest = std::size_t{1} << 30U;
    auto json = nlohmann::ordered_json::parse(read_file(options.report, "report", kLargest), nullptr, false);
    if (!json.is_object() || !json.contains("organ")) {
      throw Error(ExitCode::bad_input, options.report + ": is no JSON of palpate report");
    }
    return json;
  }
  nlohmann::ordered_json json{{"title", std::filesystem::path(options.file).filename().string()},
                              {"organ", report::organ_of_file(input.view())},
                              {"contents", contents_of(input.view(), options.file)}};
  json["organ"]["command"] = "palpate export " + options.file + " --curves curves.csv";
  return json;
}

void run_view(const ViewArguments& options, const Globals& globals) {
  const ResponseInput input(options.file);
  static_cast<void>(input.tool(options.tool));  // one that is not there is wrong without a run, too
  nlohmann::ordered_json numbers = numbers_of(options, input);
  numbers.erase("compared");  // its file is not here
  numbers.erase("run");
  if (!options.run.empty()) {
    numbers["live"] = "/run";
    report::played_run(options.run, input, options.tool);  // what is wrong with it is found before anybody looks
  }
  report::PageServerOptions server;
  server.port = options.port;
  server.page =
      report::page(numbers, {std::span(reinterpret_cast<const std::byte*>(input.view().bytes), input.view().size)});
  server.run = [&] {
    if (options.run.empty()) throw Error(ExitCode::usage, "palpate view was given no run");
    return report::played_run(options.run, input, options.tool).dump();
  };
  server.ready = [&](int port) {
    const std::string url = "http://127.0.0.1:" + std::to_string(port) + "/";
    if (globals.json) {
      print_json({{"url", url}});
    } else {
      print(url + "\n");
    }
    note(globals, "Ctrl-C ends it");
  };
  server.stop = [] { return interrupted(); };
  const InterruptPolling polling;
  report::serve_page(server);
}

}  // namespace

void add_view(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<ViewArguments>();
  Command command(app, "view", "Serves a response file's page on localhost, with a run played back in it");
  command.option("file", options->file, "Response file (.palp)").required();
  command.option("run", options->run, "Motion (CSV), or recording of 'palpate drive', which may still be written");
  command.option("--report", options->report, "JSON of 'palpate report': its sections are shown, too");
  command.option("--tool", options->tool, "Tool of the run; default: the run's, or the first");
  command.option("--port", options->port, "Port of 127.0.0.1; 0: a free one").check(whole_in(0, 65535)).shows_default();
  command.runs([options, &globals] { run_view(*options, globals); });
}

}  // namespace palpate::cli
