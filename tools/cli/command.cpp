// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <limits>
#include <sstream>
#include <thread>

#include "formats/io/error.hpp"
#include "tools/cli/blas.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"

namespace palpate::cli {
namespace {

template <typename Number>
Check range_check(Number low, Number high) {
  std::ostringstream range;
  range << "[" << low << ", " << high << "]";
  return {"in " + range.str(), [low, high, text = range.str()](const std::string& value) -> std::string {
            Number number{};
            if (CLI::detail::lexical_cast(value, number) && number >= low && number <= high) return {};
            return "got " + value + "; allowed " + text;
          }};
}

/// CLI11 reads -1 into an unsigned variable as its largest value, and takes that for what is larger, too.
template <typename Number>
CLI::Validator fits() {
  return CLI::Validator(
      [](const std::string& value) {
        Number number{};
        const auto error = std::from_chars(value.data(), value.data() + value.size(), number).ec;
        const bool wrong = value.starts_with('-') || error == std::errc::result_out_of_range;
        const std::string most = std::to_string(std::numeric_limits<Number>::max());
        return wrong ? "got " + value + "; allowed 0 to " + most : std::string();
      },
      "");
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

}  // namespace

Check number_in(double low, double high) { return range_check(low, high); }

Check whole_in(long long low, long long high) { return range_check(low, high); }

Check one_of(std::vector<std::string> words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "{" : ",") + word;
  list += "}";
  return {list, [words = std::move(words), list](const std::string& value) {
            const bool is = std::find(words.begin(), words.end(), value) != words.end();
            return is ? std::string() : value + " not in " + list;
          }};
}

Option Option::required() { return Option(option_->required()); }

Option Option::check(const Check& check) {
  return Option(option_->check(
      CLI::Validator([refuse = check.refuse](std::string& value) { return refuse(value); }, check.description)));
}

Option Option::shows_default() { return Option(option_->capture_default_str()); }

Option Option::named(const std::string& value_name) { return Option(option_->type_name(value_name)); }

Option Option::needs(const std::string& other) { return Option(option_->needs(other)); }

Option Option::excludes(Option other) { return Option(option_->excludes(other.option_)); }

Command::Command(CLI::App& app, const std::string& name, const std::string& help)
    : command_(app.add_subcommand(name, help)) {}

#define PALPATE_OPTION_OF(Type)                                                            \
  Option Command::option(const std::string& names, Type& value, const std::string& help) { \
    return Option(command_->add_option(names, value, help));                               \
  }
PALPATE_OPTION_OF(std::string)
PALPATE_OPTION_OF(double)
PALPATE_OPTION_OF(std::optional<double>)
PALPATE_OPTION_OF(int)
#undef PALPATE_OPTION_OF

#define PALPATE_OPTION_OF(Type)                                                            \
  Option Command::option(const std::string& names, Type& value, const std::string& help) { \
    return Option(command_->add_option(names, value, help)->check(fits<Type>()));          \
  }
PALPATE_OPTION_OF(std::uint32_t)
PALPATE_OPTION_OF(std::uint64_t)
#undef PALPATE_OPTION_OF

Option Command::option(const std::string& names, std::vector<std::string>& values, const std::string& help) {
  return Option(command_->add_option(names, values, help)->allow_extra_args(false));
}

Option Command::flag(const std::string& names, bool& value, const std::string& help) {
  return Option(command_->add_flag(names, value, help));
}

void Command::runs(std::function<void()> action) { command_->callback(std::move(action)); }

bool Command::given(const std::string& name) const { return command_->count(name) > 0; }

int run_command_line(int argc, char** argv) {
  Globals globals;
  globals.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));

  CLI::App app("Palpate: bakes the contact of instruments with soft organs, and plays it back at haptic rate.",
               "palpate");
  app.set_version_flag("--version", [] {
    const std::string kernels = blas_kernels();
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
      "5 result outside the required tolerance, 128 + signal when interrupted.");

#define PALPATE_COMMAND(name) add_##name(app, globals);
#include "command_list.inc"
#undef PALPATE_COMMAND

  try {
    app.parse(argc, argv);
    return static_cast<int>(ExitCode::done);
  } catch (const CLI::Success& request) {  // --help, --version
    std::ostringstream text;
    const int code = app.exit(request, text, text);
    print(text.str());
    return code;
  } catch (const CLI::ParseError& error) {
    throw Error(ExitCode::usage, usage_error(app, error) + "\nRun 'palpate --help' for what there is.");
  }
}

}  // namespace palpate::cli
