// SPDX-License-Identifier: MIT
// Recording CSV, line by line.
#include "formats/recording/recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <string_view>

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"

namespace palpate {
namespace {

constexpr std::size_t kLargest = std::size_t{1} << 28;
constexpr double kFarthest = 100.0;    // m, as coordinates of scenes
constexpr double kLargestForce = 1e9;  // N
constexpr double kLargestWeight = 1e6;

enum Column : std::size_t { x, y, z, dx, dy, dz, fx, fy, fz, site, tool, tool_vertex, weight, t, columns };
constexpr std::array<const char*, columns> kNames{"x",  "y",  "z",    "dx",   "dy",          "dz",     "fx",
                                                  "fy", "fz", "site", "tool", "tool_vertex", "weight", "t"};

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  return text;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::string shown(std::string_view text) { return std::string("'").append(text.substr(0, 40)).append("'"); }

class Reader {
public:
  explicit Reader(const std::filesystem::path& file) : file_(file), text_(read_file(file, "recording", kLargest)) {
    place_.fill(-1);
  }

  Recording read() {
    Recording recording;
    std::string_view rest = text_;
    if (rest.substr(0, 3) == "\xEF\xBB\xBF") rest.remove_prefix(3);  // spreadsheets begin UTF-8 so
    bool header = false;
    while (!rest.empty()) {
      const std::size_t end = rest.find('\n');
      const std::string_view line = trimmed(rest.substr(0, end));
      rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
      ++line_;
      if (line.empty() || line.front() == '#') continue;
      if (!header) {
        read_header(split(line));
        header = true;
      } else {
        recording.rows.push_back(row(split(line)));
      }
    }
    if (!header) fail_whole("has no header");
    if (recording.rows.empty()) fail_whole("has a header and no row");
    return recording;
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ExitCode::bad_input, file_.string() + ":" + std::to_string(line_) + ": " + what);
  }
  [[noreturn]] void fail_whole(const std::string& what) const {
    throw Error(ExitCode::bad_input, file_.string() + ": the recording " + what);
  }
  [[nodiscard]] bool has(Column column) const { return place_[column] >= 0; }

  void read_header(const std::vector<std::string_view>& names) {
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto* const found = std::find(kNames.begin(), kNames.end(), names[k]);
      if (found == kNames.end()) {
        std::string all;
        for (const char* name : kNames) all += (all.empty() ? "" : ", ") + std::string(name);
        fail("unknown column " + shown(names[k]) + "; allowed: " + all);
      }
      int& place = place_[static_cast<std::size_t>(found - kNames.begin())];
      if (place >= 0) fail("the column " + shown(names[k]) + " is there twice");
      place = static_cast<int>(k);
    }
    count_ = names.size();
    for (const Column column : {dx, dy, dz, fx, fy, fz}) {
      if (!has(column)) fail(std::string("the column '") + kNames[column] + "' is missing");
    }
    const bool point = has(x) && has(y) && has(z);
    if (point == has(site) || (has(site) && (has(x) || has(y) || has(z)))) {
      fail("the contact's place needs either the columns x, y, z or the column site");
    }
  }

  RecordedRow row(const std::vector<std::string_view>& fields) const {
    if (fields.size() != count_) {
      fail("got " + std::to_string(fields.size()) + " fields, the header has " + std::to_string(count_));
    }
    RecordedRow r;
    r.line = line_;
    if (has(site)) {
      r.site = whole(fields, site);
    } else {
      r.point = vector(fields, x, kFarthest);
    }
    r.deflection = vector(fields, dx, kFarthest);
    r.force = vector(fields, fx, kLargestForce);
    if (has(tool)) r.tool = field(fields, tool);
    if (has(tool_vertex)) r.tool_vertex = whole(fields, tool_vertex);
    if (has(weight)) r.weight = number(fields, weight, 0, kLargestWeight);
    if (has(t)) number(fields, t, -1e15, 1e15);
    return r;
  }

  [[nodiscard]] std::string_view field(const std::vector<std::string_view>& fields, Column column) const {
    return fields[static_cast<std::size_t>(place_[column])];
  }

  double number(const std::vector<std::string_view>& fields, Column column, double low, double high) const {
    const std::string_view text = field(fields, column);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value >= low && value <= high)) {
      char range[80];
      std::snprintf(range, sizeof range, "%g <= %s <= %g", low, kNames[column], high);
      fail(std::string("column ") + kNames[column] + ": got " + shown(text) + "; allowed a number, " + range);
    }
    return value;
  }

  Eigen::Vector3d vector(const std::vector<std::string_view>& fields, Column first, double most) const {
    Eigen::Vector3d v;
    for (int k = 0; k < 3; ++k) v[k] = number(fields, static_cast<Column>(first + k), -most, most);
    return v;
  }

  std::int64_t whole(const std::vector<std::string_view>& fields, Column column) const {
    const std::string_view text = field(fields, column);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < 0) {
      fail(std::string("column ") + kNames[column] + ": got " + shown(text) + "; allowed a whole number from 0");
    }
    return value;
  }

  std::filesystem::path file_;
  std::string text_;
  std::size_t line_ = 0, count_ = 0;
  std::array<int, columns> place_{};  // of each column in a row; -1: not there
};

}  // namespace

Recording read_recording(const std::filesystem::path& file) { return Reader(file).read(); }

}  // namespace palpate
