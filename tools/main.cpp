// SPDX-License-Identifier: GPL-3.0-or-later
// The `palpate` executable: parses the command line, runs one command, turns errors into exit codes.
#include "formats/error.hpp"
#include "tools/blas.hpp"
#include "tools/commands.hpp"
#include "tools/interrupt.hpp"
#include "tools/output.hpp"

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>
#include <sstream>
#include <thread>

namespace {

using palpate::ExitCode;

int report(ExitCode code, const char* message) {
  std::fprintf(stderr, "palpate: error: %s\n", message);
  return static_cast<int>(code);
}

/// CLI11 says of a misspelled command only that there is none.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> rest = app.remaining();
  if (!app.get_subcommands().empty() || rest.empty()) return error.what();
  std::string names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names += (names.empty() ? "" : ", ") + command->get_name();
  }
  return (rest.front().front() == '-' ? "unknown option '" : "unknown command '") + rest.front() +
         "'; the commands are: " + names;
}

int run(int argc, char** argv) {
  palpate::cli::Globals globals;
  globals.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));

  CLI::App app("Palpate: bakes the contact of instruments with soft organs, and plays it back at haptic rate.",
               "palpate");
  app.set_version_flag("--version", [] {
    const std::string kernels = palpate::cli::blas_kernels();
    return std::string("palpate ") + PALPATE_VERSION + (kernels.empty() ? "" : "\nOpenBLAS kernels: " + kernels);
  });
  app.set_help_all_flag("--help-all", "Print the help of every command");
  app.add_flag("--json", globals.json, "Print the result as JSON on standard output");
  app.add_flag("-q,--quiet", globals.quiet, "No progress, no notes");
  app.add_option("--threads", globals.threads, "Worker threads")->check(CLI::Range(1, 1024))->capture_default_str();
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      "Exit codes: 0 done, 1 wrong usage, 2 bad input, 3 numerical failure, 4 I/O failure,\n"
      "5 result outside the asked tolerance, 128 + signal when interrupted.");

#define PALPATE_COMMAND(name) palpate::cli::add_##name(app, globals);
#include "command_list.inc"
#undef PALPATE_COMMAND

  try {
    app.parse(argc, argv);
    return static_cast<int>(ExitCode::done);
  } catch (const CLI::Success& request) {  // --help, --version
    std::ostringstream text;
    const int code = app.exit(request, text, text);
    palpate::cli::print(text.str());
    return code;
  } catch (const CLI::ParseError& error) {
    return report(ExitCode::usage, (usage_error(app, error) + "\nRun 'palpate --help' for what there is.").c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  palpate::cli::use_right_blas_kernels(argv);
  // A file that outgrows its limit is an I/O error with a message, not a death by signal.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return run(argc, argv);
  } catch (const palpate::Error& error) {
    return report(error.code(), error.what());
  } catch (const palpate::cli::Interrupted& interruption) {
    std::fprintf(stderr, "palpate: %s\n", interruption.what());
    return palpate::cli::interrupt_exit_code();
  } catch (const std::filesystem::filesystem_error& error) {
    return report(ExitCode::io, error.what());
  } catch (const std::bad_alloc&) {
    return report(ExitCode::io, "out of memory");
  } catch (const std::exception& error) {
    return report(ExitCode::numerical, (std::string("unexpected: ") + error.what()).c_str());
  }
}
