// SPDX-License-Identifier: GPL-3.0-or-later
// The two files of a report.
#pragma once

#include <cstddef>
#include <string>

#include "tools/cli/commands.hpp"
#include "tools/report/report.hpp"

namespace palpate::report {

struct ReportFiles {
  std::string numbers, page;   ///< given: names to write to; empty: NAME.report.json, .html beside the response file
  std::string work, response;  ///< as of the pipeline
};

struct WrittenReport {
  std::string numbers, page;  ///< names; no page where the program has none
  std::size_t page_bytes = 0;
};

/// Prepares the scene, makes its report and writes both files, or the numbers alone where the program has no page.
/// Throws as the pipeline and make_report do.
WrittenReport write_report_files(const ReportInput& input, const ReportFiles& files, const cli::Globals& globals);

/// {numbers, page, page_bytes}
nlohmann::ordered_json to_json(const WrittenReport& written);
std::string to_text(const WrittenReport& written);

}  // namespace palpate::report
