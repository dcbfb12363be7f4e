// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

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

/// CLI11 reads -1 into an unsigned variable as its largest value.
CLI::Validator not_negative() {
  return CLI::Validator(
      [](const std::string& value) {
        return value.starts_with('-') ? "got " + value + "; allowed 0 and more" : std::string();
      },
      "");
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
    return Option(command_->add_option(names, value, help)->check(not_negative()));        \
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

}  // namespace palpate::cli
