// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/files.hpp"

#include <memory>
#include <nlohmann/json.hpp>

#include "formats/io/file.hpp"
#include "formats/io/same_file.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/verify_checks.hpp"
#include "tools/report/page.hpp"

namespace palpate::report {
namespace {

std::string beside(const pipeline::Pipeline& p, const std::string& given, const char* extension) {
  if (!given.empty()) return given;
  return (p.paths.response.parent_path() / (p.paths.response.stem().string() + extension)).string();
}

std::span<const std::byte> bytes_of(const cli::ResponseInput& file) {
  return {reinterpret_cast<const std::byte*>(file.view().bytes), file.view().size};
}

}  // namespace

WrittenReport write_report_files(const ReportInput& input, const ReportFiles& files, const cli::Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(input.scene, {files.work, files.response});
  WrittenReport written{beside(p, files.numbers, ".report.json"), beside(p, files.page, ".report.html"), 0};
  std::vector<std::filesystem::path> read = pipeline::files_of(input.scene, {files.work, files.response});
  read.insert(read.end(), {input.verify, input.battery, input.compared, input.run});
  for (const std::string& scene : input.beside) {
    for (std::filesystem::path& file : pipeline::files_of(scene)) read.push_back(std::move(file));
  }
  refuse_same({written.numbers, written.page}, read);
  cli::check_writable(written.numbers);
  if (has_page()) cli::check_writable(written.page);
  pipeline::plan_baked(p);
  const cli::ResponseInput response(p.paths.response);
  cli::check_same_plan(p, response.view());
  const nlohmann::ordered_json numbers = make_report(input, p, response, globals);
  cli::write_report(written.numbers, numbers);
  if (!has_page()) {
    written.page.clear();
    return written;
  }
  std::vector<std::span<const std::byte>> responses{bytes_of(response)};
  std::unique_ptr<cli::ResponseInput> compared;
  if (!input.compared.empty()) {
    compared = std::make_unique<cli::ResponseInput>(input.compared);
    responses.push_back(bytes_of(*compared));
  }
  const std::string html = page(numbers, responses);
  write_file(written.page, html);
  written.page_bytes = html.size();
  return written;
}

nlohmann::ordered_json to_json(const WrittenReport& written) {
  nlohmann::ordered_json json{{"numbers", written.numbers}};
  if (!written.page.empty()) json.update({{"page", written.page}, {"page_bytes", written.page_bytes}});
  return json;
}

std::string to_text(const WrittenReport& written) {
  std::string text = written.numbers + "\n";
  if (!written.page.empty()) text += written.page + ", " + std::to_string(written.page_bytes) + " bytes\n";
  return text;
}

}  // namespace palpate::report
