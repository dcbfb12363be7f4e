// SPDX-License-Identifier: GPL-3.0-or-later
// One command of the `palpate` executable and its options: what the commands need of CLI11, without its header. (Every
// file that includes CLI11 compiles the whole of it again, five seconds each.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpate::cli {

/// A condition on the value of an option.
struct Check {
  std::string description;                                      ///< for the help text
  std::function<std::string(const std::string& value)> refuse;  ///< what is wrong with it; empty: nothing
};

/// A number in [low, high]; NaN is not.
Check number_in(double low, double high);

/// A whole number in [low, high].
Check whole_in(long long low, long long high);

/// One of these words.
Check one_of(std::vector<std::string> words);

/// An option of a command; a handle, to be copied at will.
class Option {
public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  Option check(const Check& check);
  Option shows_default();                       ///< in the help text: the value that the variable has now
  Option named(const std::string& value_name);  ///< in the help text, what stands for a value
  Option needs(const std::string& other);       ///< wrong usage without the other one
  Option excludes(Option other);                ///< wrong usage together with the other one

private:
  CLI::Option* option_;
};

/// A command; a handle, to be copied at will. The variables must outlive parsing.
class Command {
public:
  Command(CLI::App& app, const std::string& name, const std::string& help);

  /// `names` is "file" (by its place) or "--file".
  Option option(const std::string& names, std::string& value, const std::string& help);
  Option option(const std::string& names, double& value, const std::string& help);
  Option option(const std::string& names, std::optional<double>& value, const std::string& help);
  Option option(const std::string& names, int& value, const std::string& help);
  Option option(const std::string& names, std::uint32_t& value, const std::string& help);
  Option option(const std::string& names, std::uint64_t& value, const std::string& help);
  /// May be given any number of times, each with one value.
  Option option(const std::string& names, std::vector<std::string>& values, const std::string& help);
  Option flag(const std::string& names, bool& value, const std::string& help);

  /// Sets the action of the command, run once its line is parsed.
  void runs(std::function<void()> action);

  /// Whether the line gives an option. Call it while the command runs.
  bool given(const std::string& name) const;

private:
  CLI::App* command_;
};

/// Parses the command line and runs its command; returns the exit code. Throws Error(usage) for a line that does not
/// parse, and everything that the command throws.
int run_command_line(int argc, char** argv);

}  // namespace palpate::cli
