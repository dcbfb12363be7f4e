// SPDX-License-Identifier: MIT
// Splits text into lines and words, and numbers with the position in the error; shared by the screens.
#pragma once

#include "formats/io/error.hpp"
#include "formats/surface/surface_plain.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::detail {

/// Walks over the words of a text, or over its lines, and counts the lines. Lines end by a line feed, a carriage
/// return or both; a byte-order mark of UTF-8 at the beginning is passed over.
class TextScan {
public:
  TextScan(std::string_view text, std::filesystem::path file) : text_(text), file_(std::move(file)) {
    if (text_.starts_with("\xEF\xBB\xBF")) next_ = 3;
    if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) fail("text of 16 bits; save it as UTF-8");
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw Error(ExitCode::bad_input, file_.string() + ":" + std::to_string(line_) + ": " + cause);
  }

  /// Moves to the next line; false at the end.
  bool next_line() {
    if (next_ >= text_.size()) return false;
    const auto end = std::min(text_.find_first_of("\r\n", next_), text_.size());
    current_ = text_.substr(next_, end - next_);
    next_ = end + (text_.substr(end, 2) == "\r\n" ? 2 : 1);
    ++line_;
    return true;
  }

  /// Moves to the next line, with those behind it that a '\' at the end of the line before continues.
  bool next_continued_line() {
    if (!next_line()) return false;
    if (!current_.ends_with('\\')) return true;
    joined_ = current_.substr(0, current_.size() - 1);
    for (bool more = true; more && next_line();) {
      more = current_.ends_with('\\');
      (joined_ += ' ') += current_.substr(0, current_.size() - (more ? 1 : 0));
    }
    current_ = joined_;
    return true;
  }

  /// Next word, on this line or a later one; empty at the end of the text.
  std::string_view token() {
    auto found = word();
    while (found.empty() && next_line()) found = word();
    return found;
  }

  /// Bytes before the next line.
  [[nodiscard]] std::size_t offset() const noexcept { return std::min(next_, text_.size()); }

  /// Next word of the current line; empty at its end.
  std::string_view word() {
    constexpr std::string_view space = " \t\r\v\f";
    const auto begin = current_.find_first_not_of(space);
    if (begin == std::string_view::npos) {
      current_ = {};
      return {};
    }
    const auto end = std::min(current_.find_first_of(space, begin), current_.size());
    const auto found = current_.substr(begin, end - begin);
    current_.remove_prefix(end);
    return found;
  }

  /// The rest of the current line, without the space around it.
  std::string_view rest() {
    constexpr std::string_view space = " \t\r\v\f";
    const auto begin = current_.find_first_not_of(space);
    if (begin == std::string_view::npos) return {};
    const auto end = current_.find_last_not_of(space);
    return current_.substr(begin, end - begin + 1);
  }

  /// Cuts a trailing comment off the current line.
  void drop_comment() { current_ = current_.substr(0, std::min(current_.find('#'), current_.size())); }

  double coordinate(std::string_view token, const std::string& what) const {
    if (token.empty()) fail(what + ": a coordinate is missing");
    std::string_view digits = token.front() == '+' ? token.substr(1) : token;
    double value = 0;
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (end != digits.data() + digits.size() || code == std::errc::invalid_argument) {
      fail(what + ": '" + std::string(token) + "' is not a number");
    }
    // Too small for a double is zero for every purpose; too large is refused with the infinities.
    if (code == std::errc::result_out_of_range) value = digits.find('-', 1) == std::string_view::npos ? INFINITY : 0.0;
    if (!std::isfinite(value) || std::abs(value) > largest_coordinate) {
      fail(what + ": coordinate " + std::string(token) + " is not finite or beyond 1e15");
    }
    return value;
  }

  std::int64_t integer(std::string_view token, const std::string& what) const {
    std::int64_t value = 0;
    const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (token.empty() || end != token.data() + token.size() || code != std::errc()) {
      fail(what + ": '" + std::string(token) + "' is not a whole number");
    }
    return value;
  }

  [[nodiscard]] std::size_t line() const noexcept { return line_; }

private:
  std::string_view text_, current_;
  std::string joined_;
  std::size_t next_ = 0, line_ = 0;
  std::filesystem::path file_;
};

/// Whether two words are equal but for the case of their letters.
inline bool same_word(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; };
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [&](char x, char y) { return lower(x) == lower(y); });
}

/// Ends the polygon whose corners were appended, or takes them back where less than three differ. True: it counts.
inline bool end_polygon(PolygonSoup& soup) {
  std::vector<std::int32_t> corners(soup.corners.begin() + std::ptrdiff_t(soup.first.back()), soup.corners.end());
  std::sort(corners.begin(), corners.end());
  if (std::unique(corners.begin(), corners.end()) - corners.begin() < 3) {
    soup.corners.resize(soup.first.back());
    return false;
  }
  soup.end_polygon();
  return true;
}

/// Notes how many digits behind the point a coordinate has.
inline void count_decimals(PolygonSoup& soup, std::string_view token) {
  if (token.find_first_of("eE") != std::string_view::npos) {
    soup.decimals = 99;
    return;
  }
  const auto point = token.find('.');
  const int digits = point == std::string_view::npos ? 0 : int(token.size() - point) - 1;
  soup.decimals = std::max(soup.decimals, digits);
}

}  // namespace palpate::detail
