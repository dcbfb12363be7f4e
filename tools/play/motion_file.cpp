// SPDX-License-Identifier: GPL-3.0-or-later
// Motion CSV, strictly: a wrong line is an error, not a guess.
#include "tools/play/motion_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"

namespace palpate::cli {
namespace {

constexpr const char* kHeader = "t,x,y,z,qw,qx,qy,qz";
constexpr std::string_view kMark = "\xef\xbb\xbf";  // that some programs begin a UTF-8 file with
constexpr std::size_t kLargest = std::size_t{1} << 30;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  return text;
}

class Reader {
public:
  explicit Reader(const std::filesystem::path& file) : file_(file), text_(read_file(file, "motion", kLargest)) {}

  std::vector<MotionRow> read() {
    std::string_view rest = text_;
    if (rest.starts_with(kMark)) rest.remove_prefix(kMark.size());
    std::vector<MotionRow> rows;
    while (!rest.empty()) {
      const std::size_t end = rest.find('\n');
      const std::string_view line = trimmed(rest.substr(0, end));
      rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
      ++line_;
      if (line_ == 1) {
        check_header(line);
      } else if (!line.empty()) {
        rows.push_back(row(line));
        if (rows.size() > 1 && rows.back().time <= rows[rows.size() - 2].time) {
          fail("time " + std::to_string(rows.back().time) + " s is not after the row before");
        }
      }
    }
    if (line_ == 0) check_header("");
    if (rows.empty()) throw Error(ExitCode::bad_input, file_.string() + ": the motion has no rows");
    return rows;
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ExitCode::bad_input, file_.string() + ":" + std::to_string(line_) + ": " + what);
  }

  void check_header(std::string_view line) {
    std::string packed;
    for (const char c : line) {
      if (c != ' ' && c != '\t') packed += c;
    }
    if (packed != kHeader) {
      line_ = 1;
      fail(std::string("the first line must be the header ") + kHeader);
    }
  }

  double number(std::string_view field, int column) const {
    double value = 0;
    const std::string_view text = trimmed(field);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
      fail("column " + std::to_string(column) + ": '" + std::string(text.substr(0, 40)) + "' is not a finite number");
    }
    return value;
  }

  MotionRow row(std::string_view line) const {
    double values[8] = {};
    int count = 0;
    for (bool more = true; more; ++count) {
      const std::size_t comma = line.find(',');
      more = comma != std::string_view::npos;
      if (count < 8) values[count] = number(line.substr(0, comma), count + 1);
      if (more) line.remove_prefix(comma + 1);
    }
    if (count != 8) fail(std::to_string(count) + " columns, expected 8: " + kHeader);
    const double length = std::hypot(std::hypot(values[4], values[5]), std::hypot(values[6], values[7]));
    if (std::abs(length - 1) > 0.01) {
      fail("the quaternion's length is " + std::to_string(length) + ", allowed 0.99 to 1.01");
    }
    for (int k = 1; k < 4; ++k) {
      if (std::abs(values[k]) >= 1e6) fail("column " + std::to_string(k + 1) + ": beyond 1e6 m");
    }
    return {values[0], {values[1], values[2], values[3]}, {values[4], values[5], values[6], values[7]}};
  }

  std::filesystem::path file_;
  std::string text_;
  std::size_t line_ = 0;
};

}  // namespace

std::vector<MotionRow> read_motion(const std::filesystem::path& file) { return Reader(file).read(); }

std::string motion_hint(const std::vector<MotionRow>& rows, const runtime::Vec3& low, const runtime::Vec3& high) {
  constexpr double kAway = 5, kNear = 1;  // body diagonals from the body's middle
  constexpr double kSlow = 0.5;           // s between rows: no motion is sampled that seldom
  constexpr std::size_t kFew = 10;        // rows that may well be set by hand
  const runtime::Vec3 middle = 0.5 * (low + high);
  const double size = length(high - low);
  double nearest = INFINITY, nearest_scaled = INFINITY;
  for (const MotionRow& row : rows) {
    nearest = std::min(nearest, length(row.position - middle));
    nearest_scaled = std::min(nearest_scaled, length(1e-3 * row.position - middle));
  }
  std::string hint;
  char text[200];
  if (size > 0 && nearest > kAway * size && nearest_scaled < kNear * size) {
    std::snprintf(text, sizeof text,
                  "the tool stays %.3g m from a body of %.3g m: the positions look like millimetres; they are in m",
                  nearest, size);
    hint = text;
  }
  if (rows.size() > kFew) {
    const double step = (rows.back().time - rows.front().time) / double(rows.size() - 1);
    if (step >= kSlow) {
      std::snprintf(text, sizeof text, "%sthe rows are %.3g s apart: the times look like milliseconds; they are in s",
                    hint.empty() ? "" : "; ", step);
      hint += text;
    }
  }
  return hint;
}

runtime::Pose pose_between(const MotionRow& a, const MotionRow& b, double share) {
  double cosine = 0, q[4];
  for (int k = 0; k < 4; ++k) cosine += a.quaternion[k] * b.quaternion[k];
  const double sign = cosine < 0 ? -1 : 1;  // the short way round
  const double angle = std::acos(std::min(1.0, std::abs(cosine)));
  // Too small an angle to divide by its sine: the straight way is as good.
  const bool turns = angle > 1e-6;
  const double from = turns ? std::sin((1 - share) * angle) / std::sin(angle) : 1 - share;
  const double to = sign * (turns ? std::sin(share * angle) / std::sin(angle) : share);
  for (int k = 0; k < 4; ++k) q[k] = from * a.quaternion[k] + to * b.quaternion[k];
  return runtime::Pose::from_quaternion(q[0], q[1], q[2], q[3], a.position + share * (b.position - a.position));
}

}  // namespace palpate::cli
