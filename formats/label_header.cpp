// SPDX-License-Identifier: MIT
// Fields of a label image's header.
#include "formats/label_header.hpp"

#include "formats/error.hpp"
#include "formats/file.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

namespace palpate::detail {

std::size_t size_of(VoxelType type) {
  switch (type) {
    case VoxelType::int8:
    case VoxelType::uint8:
      return 1;
    case VoxelType::int16:
    case VoxelType::uint16:
      return 2;
    default:
      return 4;
  }
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1));
}

std::string beginning(const std::string& line) { return std::string("'").append(line, 0, 40).append("'"); }

void LabelHeader::fail(const std::string& field, const std::string& what) const {
  throw Error(ExitCode::bad_input, file_.string() + ": " + (field.empty() ? "" : field + ": ") + what);
}

void LabelHeader::set(const std::string& field, std::string value) {
  if (!fields_.emplace(lower(field), std::move(value)).second) fail(field, "stands twice in the header");
}

std::optional<std::string> LabelHeader::get(std::initializer_list<const char*> names) const {
  for (const char* name : names) {
    if (const auto at = fields_.find(name); at != fields_.end()) return at->second;
  }
  return std::nullopt;
}

std::string LabelHeader::need(std::initializer_list<const char*> names) const {
  if (auto value = get(names)) return *value;
  fail(*names.begin(), "missing");
}

std::vector<double> LabelHeader::numbers(const std::string& field, std::string value, std::size_t count) const {
  std::replace_if(
      value.begin(), value.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
  std::vector<double> all;
  for (const char *at = value.data(), *end = at + value.size(); at != end;) {
    if (*at == ' ' || *at == '\t') {
      ++at;
      continue;
    }
    double number = 0;
    const auto [next, code] = std::from_chars(at, end, number);
    if (code != std::errc() || !std::isfinite(number)) fail(field, "got '" + value + "'; allowed: numbers");
    all.push_back(number);
    at = next;
  }
  if (all.size() != count) {
    fail(field, "got " + std::to_string(all.size()) + " numbers; allowed " + std::to_string(count));
  }
  return all;
}

std::array<int, 3> LabelHeader::size(const std::string& field, const std::string& value) const {
  std::array<int, 3> size{};
  std::size_t total = 1;
  const std::vector<double> sizes = numbers(field, value, 3);
  for (std::size_t k = 0; k < 3; ++k) {
    const double n = sizes[k];
    if (!(n >= 1 && n <= 65536 && n == std::floor(n))) fail(field, "allowed: whole numbers from 1 to 65536");
    size[k] = static_cast<int>(n);
    total *= static_cast<std::size_t>(n);
    if (total > largest_image) fail(field, "more than 2^31 voxels");
  }
  return size;
}

VoxelType LabelHeader::type(const std::string& field, const std::string& name,
                            const std::map<std::string, VoxelType>& known) const {
  const auto at = known.find(lower(name));
  if (at != known.end()) return at->second;
  fail(field, "got '" + name + "'; allowed: whole numbers of 8, 16 or 32 bits");
}

void LabelHeader::set_frame(VoxelData& data, const std::string& field, const std::vector<double>& axes,
                            const std::vector<double>& origin, double unit) const {
  for (int k = 0; k < 3; ++k) {
    data.origin[k] = unit * origin[std::size_t(k)];
    for (int i = 0; i < 3; ++i) data.axes(i, k) = unit * axes[std::size_t(3 * k + i)];
  }
  const double volume = std::abs(data.axes.determinant());
  const double lengths = data.axes.col(0).norm() * data.axes.col(1).norm() * data.axes.col(2).norm();
  if (!(volume > 1e-6 * lengths) || !std::isfinite(lengths)) fail(field, "the axes of the voxels span no space");
}

void LabelHeader::check_unit(const std::string& field, const std::string& name, double unit) const {
  static const std::map<std::string, double> lengths{{"m", 1.0},
                                                     {"meter", 1.0},
                                                     {"cm", 0.01},
                                                     {"mm", 0.001},
                                                     {"millimeter", 0.001},
                                                     {"millimeters", 0.001},
                                                     {"millimetre", 0.001},
                                                     {"um", 1e-6},
                                                     {"in", 0.0254}};
  const auto at = lengths.find(lower(name));
  if (at == lengths.end() || at->second == unit) return;
  fail(field, "the file is in " + name + ", the scene says otherwise; allowed: units = \"" + name + "\"");
}

std::string LabelHeader::data_beside(const std::string& field, const std::string& name) const {
  if (name.find(' ') != std::string::npos || lower(name) == "list") fail(field, "allowed: one file");
  return read_file(file_.parent_path() / name, "label image", largest_image);
}

}  // namespace palpate::detail
