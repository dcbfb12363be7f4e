// SPDX-License-Identifier: MIT
// Value checks of the scene reader.
#include "formats/scene/scene_value.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <sstream>

namespace palpate::scene_io {

namespace {

/// The value as it stands in the file, shortened for a message.
std::string got(const toml::node& node) {
  std::ostringstream text;
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      if (node.as_array()->empty()) return "an empty array";
      text << *node.as_array();
      break;
    case toml::node_type::string:
      text << show(node.as_string()->get());
      break;
    case toml::node_type::integer:
      text << node.as_integer()->get();
      break;
    case toml::node_type::floating_point:
      return show(node.as_floating_point()->get());
    case toml::node_type::boolean:
      return node.as_boolean()->get() ? "true" : "false";
    default:
      return "a date or time";
  }
  std::string result = text.str();
  constexpr std::size_t longest = 80;
  if (result.size() > longest) result = result.substr(0, longest) + "...";
  return result;
}

}  // namespace

std::string Range::text() const {
  std::string result;
  if (std::isfinite(low)) result += show(low) + (low_open ? " < " : " <= ");
  result += "x";
  if (std::isfinite(high)) result += " <= " + show(high);
  if (!std::isfinite(low) && !std::isfinite(high)) result = "any finite number";
  if (*unit != '\0') result += std::string(" ") + unit;
  return result;
}

void fail(const Place& place, const toml::node* node, const std::string& what) {
  std::string message = place.file.string();
  if (node != nullptr && node->source().begin.line > 0) message += ":" + std::to_string(node->source().begin.line);
  message += ": ";
  if (!place.key.empty()) message += place.key + ": ";
  throw Error(ExitCode::bad_input, message + what);
}

void fail_value(const Place& place, const toml::node& node, const std::string& allowed) {
  fail(place, &node, "got " + got(node) + "; allowed " + allowed);
}

double to_number(const Place& place, const toml::node& node, const Range& range) {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (const auto* floating = node.as_floating_point()) {
    value = floating->get();
  } else if (const auto* integer = node.as_integer()) {
    value = static_cast<double>(integer->get());
  } else {
    fail_value(place, node, "a number, " + range.text());
  }
  if (!std::isfinite(value) || !range.contains(value)) fail_value(place, node, range.text());
  return value;
}

int to_integer(const Place& place, const toml::node& node, const Range& range, int multiple_of) {
  const std::string allowed = (multiple_of == 1   ? "a whole number, "
                               : multiple_of == 2 ? "an even whole number, "
                                                  : "a multiple of " + std::to_string(multiple_of) + ", ") +
                              range.text();
  const auto* integer = node.as_integer();
  if (integer == nullptr) fail_value(place, node, allowed);
  const std::int64_t value = integer->get();
  if (!range.contains(static_cast<double>(value)) || value % multiple_of != 0) fail_value(place, node, allowed);
  return static_cast<int>(value);
}

std::string to_text(const Place& place, const toml::node& node) {
  const auto* text = node.as_string();
  const char* allowed = "a text that is not empty and has no control characters";
  if (text == nullptr) fail_value(place, node, allowed);
  const std::string& value = text->get();
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (value.empty() || std::any_of(value.begin(), value.end(), is_control)) fail_value(place, node, allowed);
  return value;
}

std::vector<std::string> to_texts(const Place& place, const toml::node& node) {
  if (node.is_string()) return {to_text(place, node)};
  const auto* array = node.as_array();
  if (array == nullptr || array->empty()) fail_value(place, node, "a text, or an array of one or more texts");
  std::vector<std::string> result;
  for (const toml::node& element : *array) {
    result.push_back(to_text(place, element));
    if (std::count(result.begin(), result.end(), result.back()) > 1) {
      fail(place, &element, show(result.back()) + " is there twice");
    }
  }
  return result;
}

Eigen::Vector3d to_vector(const Place& place, const toml::node& node, const Range& range) {
  const auto* array = node.as_array();
  if (array == nullptr || array->size() != 3) fail_value(place, node, "[x, y, z], each " + range.text());
  Eigen::Vector3d result;
  for (int i = 0; i < 3; ++i) result[i] = to_number(place, *array->get(static_cast<std::size_t>(i)), range);
  return result;
}

std::size_t to_choice(const Place& place, const toml::node& node, const std::vector<std::string>& choices) {
  const auto* text = node.as_string();
  if (text == nullptr) fail_value(place, node, show_choices(choices));
  const auto found = std::find(choices.begin(), choices.end(), text->get());
  if (found == choices.end()) {
    const std::string near = nearest(text->get(), choices);
    fail_value(place, node, show_choices(choices) + (near.empty() ? "" : "; did you mean " + show(near) + "?"));
  }
  return static_cast<std::size_t>(found - choices.begin());
}

const toml::table& to_table(const Place& place, const toml::node& node) {
  const auto* table = node.as_table();
  if (table == nullptr) fail_value(place, node, "a table");
  return *table;
}

std::string show(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

std::string show(int value) { return std::to_string(value); }

std::string show(const std::string& value) {
  std::string result = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      constexpr const char* digits = "0123456789abcdef";
      const auto byte = static_cast<unsigned char>(c);
      result += std::string("\\u00") + digits[byte >> 4] + digits[byte & 15];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string show(const std::vector<std::string>& values) {
  std::string result = "[";
  for (const std::string& value : values) {
    if (result.size() > 1) result += ", ";
    result += show(value);
  }
  result += "]";
  return result;
}

std::string show(const Eigen::Vector3d& value) {
  std::string result = "[";
  for (int i = 0; i < 3; ++i) {
    if (i > 0) result += ", ";
    result += show(value[i]);
  }
  result += "]";
  return result;
}

std::string show_choices(const std::vector<std::string>& choices) {
  std::string result;
  for (const std::string& choice : choices) {
    if (!result.empty()) result += " | ";
    result += show(choice);
  }
  return result;
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    // Levenshtein distance, one row at a time.
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t change = diagonal + (word[i - 1] == candidate[j - 1] ? 0 : 1);
        diagonal = row[j];
        row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
      }
    }
    if (row.back() < best_distance && row.back() < candidate.size()) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace palpate::scene_io
