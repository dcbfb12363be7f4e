// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/page.hpp"

#include <zlib.h>
#include <nlohmann/json.hpp>
#include <string_view>

#include "formats/io/error.hpp"
#include "tools/report/page_template.hpp"

namespace palpate::report {
namespace {

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t left = bytes.size() - k;
    const unsigned three = bytes[k] << 16U | (left > 1 ? bytes[k + 1] << 8U : 0U) | (left > 2 ? bytes[k + 2] : 0U);
    text += kDigits[three >> 18U];
    text += kDigits[three >> 12U & 63U];
    text += left > 1 ? kDigits[three >> 6U & 63U] : '=';
    text += left > 2 ? kDigits[three & 63U] : '=';
  }
  return text;
}

std::string packed(const unsigned char* data, std::size_t size) {
  uLongf length = ::compressBound(size);
  std::vector<unsigned char> bytes(length);
  if (::compress2(bytes.data(), &length, data, size, Z_BEST_COMPRESSION) != Z_OK) {
    throw Error(ExitCode::io, "the page: zlib cannot compress " + std::to_string(size) + " bytes");
  }
  bytes.resize(length);
  return base64(bytes);
}

/// First bytes of all words of four, then the second ones, and so on.
std::vector<unsigned char> planes(std::span<const std::byte> bytes) {
  std::vector<unsigned char> sorted;
  sorted.reserve(bytes.size());
  for (std::size_t plane = 0; plane < 4; ++plane) {
    for (std::size_t k = plane; k < bytes.size(); k += 4) sorted.push_back(static_cast<unsigned char>(bytes[k]));
  }
  return sorted;
}

std::string data_block(const std::string& id, const std::string& content) {
  return "<script type=\"application/octet-stream\" id=\"" + id + "\">" + content + "</script>\n";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '<' ? std::string("&lt;") : c == '&' ? std::string("&amp;") : std::string(1, c);
  }
  return out;
}

/// Replaces every `mark` by `by`, which does not contain it.
void replace(std::string& text, std::string_view mark, const std::string& by) {
  std::size_t at = text.find(mark);
  if (at == std::string::npos) throw Error(ExitCode::io, "the page's template has no " + std::string(mark));
  for (; at != std::string::npos; at = text.find(mark, at + by.size())) text.replace(at, mark.size(), by);
}

}  // namespace

bool has_page() { return page_template().missing.empty(); }

void require_page() {
  if (has_page()) return;
  throw Error(ExitCode::usage,
              "this program was built without the page of a report: " + std::string(page_template().missing) +
                  "; mend that and build again (tools/report/README.md)");
}

std::string page(const nlohmann::ordered_json& numbers, const std::vector<std::span<const std::byte>>& responses) {
  require_page();
  const std::string json = numbers.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string data =
      data_block("palpate-numbers", packed(reinterpret_cast<const unsigned char*>(json.data()), json.size()));
  for (std::size_t k = 0; k < responses.size(); ++k) {
    const std::vector<unsigned char> sorted = planes(responses[k]);
    data += data_block("palpate-response-" + std::to_string(k), packed(sorted.data(), sorted.size()));
  }
  std::string html(page_template().html);
  replace(html, "@@TITLE@@", escaped(numbers.value("title", "report")));
  replace(html, "<!--@@DATA@@-->", data);
  return html;
}

}  // namespace palpate::report
