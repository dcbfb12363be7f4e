// SPDX-License-Identifier: GPL-3.0-or-later
// palpate bench: nanoseconds a tick and bytes a response of a file, seconds to open one, or what the solver's curves
// cost, on this machine.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/io/same_file.hpp"
#include "tools/bench/bench_rows.hpp"
#include "tools/bench/open_bench.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/play/plot.hpp"
#ifdef PALPATE_SOLVER_BENCH
#include "tools/bench/bench_models.hpp"
#include "tools/bench/bench_solver.hpp"
#endif

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BenchArguments {
  std::string file, tool, work, plot;
  bool solver = false, models = false, open = false, rows = false;
  RepeatedSize repeated;
  TickBenchOptions bench;
  double ticks = 1e6;
};

Json times_json(const TickTimes& times) {
  return {{"median", times.quantile(0.5)},
          {"p95", times.quantile(0.95)},
          {"worst", times.quantile(1)},
          {"mean", times.mean}};
}

Json every_json(const Times& times) {
  return {{"ticks", times.nanoseconds.size()},
          {"median", times.quantile(0.5)},
          {"p99.9", times.quantile(0.999)},
          {"worst", times.quantile(1)}};
}

std::string times_text(const char* name, const TickTimes& times) {
  char line[160];
  std::snprintf(line, sizeof line, "%-7s %8.1f  %8.1f  %8.1f  %8.1f\n", name, times.quantile(0.5), times.quantile(0.95),
                times.quantile(1), times.mean);
  return line;
}

std::string every_text(const char* name, const Times& times) {
  char line[160];
  std::snprintf(line, sizeof line, "%-11s %8.1f  %8.1f  %8.1f  %8.3g\n", name, times.quantile(0.5),
                times.quantile(0.999), times.quantile(1), static_cast<double>(times.nanoseconds.size()));
  return line;
}

/// A file in the folder for temporary files that has lost its name: no end of the program leaves it behind.
class TemporaryFile {
public:
  explicit TemporaryFile(const std::vector<std::byte>& bytes) : file_(nullptr, &std::fclose) {
    std::string name = (std::filesystem::temp_directory_path() / "palpate-XXXXXX").string();
    const int descriptor = ::mkstemp(name.data());
    if (descriptor >= 0) {
      ::unlink(name.c_str());
      file_.reset(::fdopen(descriptor, "wb"));
    }
    if (!file_ || std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size() ||
        std::fflush(file_.get()) != 0) {
      throw Error(ExitCode::io, name + ": cannot write the file: " + std::strerror(errno));
    }
  }
  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(::fileno(file_.get())); }

private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

/// None where the file is taken as it is.
std::unique_ptr<TemporaryFile> enlarged(const BenchArguments& options, const Globals& globals) {
  if (!(options.repeated.bytes > 0 || options.repeated.sites > 0)) return nullptr;
  note(globals, "writing a file of the body many times over");
  return std::make_unique<TemporaryFile>(repeat_body(ResponseInput(options.file).view(), options.repeated));
}

void run_open(const BenchArguments& options, const Globals& globals) {
  constexpr int kRounds = 7;
  // One that is not there is wrong, though nothing is timed of it.
  if (!options.tool.empty()) static_cast<void>(ResponseInput(options.file).tool(options.tool));
  const std::unique_ptr<TemporaryFile> large = enlarged(options, globals);
  const OpenBench bench = bench_open(large ? large->path() : std::filesystem::path(options.file), kRounds);
  if (globals.json) {
    Json parts = Json::array();
    for (const layout::SectionEntry& e : bench.parts) {
      parts.push_back({{"name", layout::section_name(e.id)}, {"bytes", e.size}, {"count", e.count}});
    }
    print_json({{"file", options.file},
                {"machine", machine_name()},
                {"bytes", bench.bytes},
                {"sites", bench.sites},
                {"responses", bench.responses},
                {"parts", parts},
                {"open_s", {{"median", bench.validated}, {"worst", bench.validated_most}}},
                {"open_trusted_s", {{"median", bench.trusted}}}});
    return;
  }
  char text[300];
  std::snprintf(text, sizeof text, "%s\n%.4g MB, %s, %s; bytes of each part a response:\n", machine_name().c_str(),
                1e-6 * static_cast<double>(bench.bytes), counted(bench.sites, "site").c_str(),
                counted(bench.responses, "response").c_str());
  std::string out = text;
  for (const layout::SectionEntry& e : bench.parts) {
    std::snprintf(text, sizeof text, "  %-18s %9.3f\n", layout::section_name(e.id),
                  static_cast<double>(e.size) / bench.responses);
    out += text;
  }
  std::snprintf(text, sizeof text, "open    median %9.4f s   worst %9.4f s\ntrusted median %9.1f us\n", bench.validated,
                bench.validated_most, 1e6 * bench.trusted);
  print(out + text);
}

/// One row of the times, as it is called on screen and in JSON.
struct TickRow {
  const char* name;
  const TickTimes& times;
};

void run_ticks(BenchArguments options, const Globals& globals) {
  const std::unique_ptr<TemporaryFile> large = enlarged(options, globals);
  const ResponseInput input(options.file);
  const std::unique_ptr<ResponseInput> repeated = large ? std::make_unique<ResponseInput>(large->path()) : nullptr;
  const runtime::View& view = input.view();
  options.bench.tool = input.tool(options.tool);
  const std::string tool = view.tools[options.bench.tool].name;
  note(globals, "timing " + std::to_string(options.bench.contacts) + " random contacts of the tool '" + tool + "'");
  const TickBench bench = bench_ticks(view, options.bench);
  const LatencyBench latency =
      bench_latency(view, repeated ? repeated->view() : view, options.bench, static_cast<std::uint64_t>(options.ticks));
  const TickRow states[] = {
      {"press", bench.press}, {"field", bench.field}, {"slide", bench.slide}, {"free", bench.free}};
  const TickRow beside[] = {{"locate", bench.locate},   {"blend", latency.blend},    {"anew", latency.anew},
                            {"random", latency.random}, {"five", latency.five},      {"joint", latency.joint},
                            {"plain", latency.plain},   {"network", latency.network}};
  if (!options.plot.empty()) {
    std::vector<PlotSeries> series;
    for (const TickRow& row : states) series.push_back({row.name, row.times.nanoseconds});
    write_file(options.plot,
               distribution_svg("Ticks of the tool '" + tool + "' on " + machine_name(), "time (ns)", series));
  }
  if (globals.json) {
    Json ticks, others;
    for (const TickRow& row : states) ticks[row.name] = times_json(row.times);
    for (const TickRow& row : beside) others[std::string(row.name) + "_ns"] = times_json(row.times);
    Json all = {{"file", options.file},
                {"machine", machine_name()},
                {"tool", tool},
                {"contacts", bench.contacts},
                {"random_among_responses", (repeated ? repeated->view() : view).meta->response_count},
                {"bytes_per_response", bytes_per_response(view)},
                {"responses_interpolated", latency.responses},
                {"tick_ns", ticks}};
    all.update(others);
    all["every_ns"] = every_json(latency.every.all);
    all["every_ns"]["undisturbed"] = every_json(latency.every.undisturbed);
    print_json(all);
    return;
  }
  char line[200];
  std::snprintf(line, sizeof line, "%s\n%s of the tool '%s', %.0f bytes a response, %d interpolated\n",
                machine_name().c_str(), counted(static_cast<std::size_t>(bench.contacts), "contact").c_str(),
                tool.c_str(), bytes_per_response(view), latency.responses);
  std::string out = line;
  out +=
      "of each contact, in ns, the least of its blocks of ticks, and the mean of all, disturbed by other work:\n"
      "          median       95 %     worst     mean\n";
  for (const TickRow& row : states) out += times_text(row.name, row.times);
  for (const TickRow& row : beside) out += times_text(row.name, row.times);
  out +=
      "each tick of strokes, in ns, the clock's own time included:\n"
      "              median    99.9 %     worst     ticks\n";
  out += every_text("every", latency.every.all);
  out += every_text("undisturbed", latency.every.undisturbed);
  print(out);
}

void run_rows(const BenchArguments& options, const Globals& globals) {
  RowsBenchOptions rows;
  rows.ticks = static_cast<std::size_t>(options.ticks);
  note(globals, "solving 120 rows in " + std::to_string(rows.ticks) + " ticks for each number of sweeps");
  rows.progress = [&](int sweeps) { note(globals, "sweeps: " + std::to_string(sweeps)); };
  Json json{{"machine", machine_name()}, {"rows", Json::array()}};
  std::string text =
      machine_name() +
      "\n120 rows (40 contacts with friction), each solve from the forces of the last tick\n"
      "        error of the force, %          above 1 %, % of ticks   time, us             undisturbed, us\n"
      "sweeps   median      95 %     worst  reported  unreported     median    99.9 %     median    99.9 %\n";
  for (const RowsBenchRow& row : bench_rows(rows)) {
    const auto error = [&](double share) {
      return row.errors[static_cast<std::size_t>(share * static_cast<double>(row.errors.size() - 1))];
    };
    char line[200];
    std::snprintf(line, sizeof line, "%6d %8.3f  %8.3f  %8.3f  %8.2f  %10.2f   %8.1f  %8.1f   %8.1f  %8.1f\n",
                  row.sweeps, 100 * error(0.5), 100 * error(0.95), 100 * error(1), 100 * row.reported, 100 * row.wrong,
                  1e-3 * row.all.quantile(0.5), 1e-3 * row.all.quantile(0.999), 1e-3 * row.undisturbed.quantile(0.5),
                  1e-3 * row.undisturbed.quantile(0.999));
    text += line;
    Json time = every_json(row.all);
    time["undisturbed"] = every_json(row.undisturbed);
    json["rows"].push_back({{"sweeps", row.sweeps},
                            {"error", {{"median", error(0.5)}, {"p95", error(0.95)}, {"worst", error(1)}}},
                            {"reported", row.reported},
                            {"unreported", row.wrong},
                            {"time_ns", time}});
  }
  globals.json ? print_json(json) : print(text);
}

void run_bench(BenchArguments options, const Globals& globals) {
  if (!options.plot.empty() && (options.solver || options.models || options.rows || options.open)) {
    throw Error(ExitCode::usage, "--plot shows ticks; leave it out with --solver, --models, --rows and --open");
  }
  if (!options.work.empty() && !options.models) throw Error(ExitCode::usage, "--work belongs to --models");
#ifdef PALPATE_SOLVER_BENCH
  if (options.solver && options.models) throw Error(ExitCode::usage, "--solver and --models exclude each other");
  if (options.solver) return run_solver_bench({options.file, options.bench.contacts}, globals);
  if (options.models) {
    if (options.file.empty()) throw Error(ExitCode::usage, "bench --models needs a scene");
    return run_model_bench({options.file, options.work, options.bench.contacts}, globals);
  }
#endif
  if (options.rows) return run_rows(options, globals);
  if (options.file.empty()) throw Error(ExitCode::usage, "bench needs a response file");
  if (!options.plot.empty()) check_writable(options.plot);
  refuse_same({options.plot}, {options.file});
  if (options.open) return run_open(options, globals);
  run_ticks(std::move(options), globals);
}

}  // namespace

void add_bench(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<BenchArguments>();
  Command command(app, "bench", "Times the ticks of a response file");
  command.option("file", options->file,
                 "Response file (.palp); with --models a scene, with --solver a scene, or nothing for a block");
#ifdef PALPATE_SOLVER_BENCH
  command.flag("--solver", options->solver, "Curve sets an hour against their error, in place of ticks");
  command.flag("--models", options->models,
               "Bytes, error and nanoseconds of every response model on the samples of a scene that was baked for "
               "the coupled one");
  command.option("--work", options->work, "With --models: work folder (default: NAME.work beside the scene)");
#endif
  command.flag("--rows", options->rows,
               "Error and time of 120 rows of a mechanism against the sweeps of a solve; no file is needed");
  command.flag("--open", options->open,
               "Seconds to map, validate and open the file, its pages in memory, and to open it unchecked, in place of "
               "ticks");
  command
      .option("--bytes", options->repeated.bytes,
              "Opens a temporary file of at least so many bytes, in which the body is repeated; without --open, "
              "random places are of it")
      .check(number_in(1, 4e9));
  command.option("--sites", options->repeated.sites, "The same, of at least so many sites").check(number_in(1, 1e8));
  command.option("--tool", options->tool, "Name of the tool; default: the file's first");
  command.option("--plot", options->plot, "Write a plot of the contacts' times here (SVG)");
  command
      .option("--contacts", options->bench.contacts,
              "Random contacts; with --solver (default 8) spread evenly over the scene's plan")
      .check(whole_in(1, 10000))
      .shows_default();
  command.option("--seed", options->bench.seed, "Seed of the random contacts").shows_default();
  command.option("--ticks", options->ticks, "Ticks of strokes, or of each number of sweeps, each timed alone")
      .check(number_in(1000, 1e9))
      .shows_default();
  command.option("--seconds", options->bench.seconds, "Measured for each contact and state")
      .check(number_in(0.001, 10.0))
      .shows_default();
  command.runs([options, command, &globals] {
    constexpr int kSolved = 8;  // fewer by default, because a solve takes seconds and a tick nanoseconds
    if (options->solver && !command.given("--contacts")) options->bench.contacts = kSolved;
    run_bench(*options, globals);
  });
}

}  // namespace palpate::cli
