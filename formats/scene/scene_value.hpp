// SPDX-License-Identifier: MIT
// From a TOML node to a checked value, and back to TOML text; every complaint names file, line, key and range.
#pragma once

#include "formats/io/error.hpp"

#include <toml++/toml.h>
#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::scene_io {

/// The place of a value in a scene: for messages, and for paths relative to the scene file.
struct Place {
  std::filesystem::path file;
  std::string key;  ///< full key, e.g. "sampling.depth"

  [[nodiscard]] Place below(std::string_view name) const {
    return {file, key.empty() ? std::string(name) : key + "." + std::string(name)};
  }
};

/// Allowed interval of a number. An open end excludes the bound itself.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  const char* unit = "";

  [[nodiscard]] bool contains(double value) const {  // false for NaN
    return (low_open ? value > low : value >= low) && value <= high;
  }
  /// "0 < x <= 1 m"
  [[nodiscard]] std::string text() const;
};

inline constexpr Range kModulus{0, 1e12, true, "Pa"};  ///< of any elastic law

/// Throws Error(bad_input) "FILE:LINE: KEY: what". `node` gives the line; null: the file as a whole.
[[noreturn]] void fail(const Place& place, const toml::node* node, const std::string& what);
/// The same with "got VALUE; allowed RANGE".
[[noreturn]] void fail_value(const Place& place, const toml::node& node, const std::string& allowed);

double to_number(const Place& place, const toml::node& node, const Range& range);
int to_integer(const Place& place, const toml::node& node, const Range& range, int multiple_of);
/// Not empty, no control characters.
std::string to_text(const Place& place, const toml::node& node);
/// One or more of them.
std::vector<std::string> to_texts(const Place& place, const toml::node& node);
Eigen::Vector3d to_vector(const Place& place, const toml::node& node, const Range& range);
/// Index of the node's text in `choices`.
std::size_t to_choice(const Place& place, const toml::node& node, const std::vector<std::string>& choices);
const toml::table& to_table(const Place& place, const toml::node& node);

/// TOML text of a value: shortest that reads back as the same bits.
std::string show(double value);
std::string show(int value);
std::string show(const std::string& value);
std::string show(const std::vector<std::string>& values);
std::string show(const Eigen::Vector3d& value);

/// `"a" | "b" | "c"`
std::string show_choices(const std::vector<std::string>& choices);

/// The candidate that `word` is probably a misspelling of; empty when none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace palpate::scene_io
