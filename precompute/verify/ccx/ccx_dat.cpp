// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/ccx/ccx_dat.hpp"

#include "formats/io/error.hpp"

#include <cmath>
#include <sstream>

namespace palpate::verify {
namespace {

[[noreturn]] void refuse(const std::string& line) {
  throw Error(ExitCode::numerical, "CalculiX' .dat file has an unexpected line: '" + line + "'");
}

double number(std::istream& in, const std::string& line) {
  std::string word;
  in >> word;
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (word.empty() || *end != '\0' || !std::isfinite(value)) refuse(line);
  return value;
}

}  // namespace

std::vector<CcxTotal> read_ccx_totals(const std::string& dat) {
  const std::string head = " total force (fx,fy,fz) for set ", middle = " and time ";
  std::vector<CcxTotal> totals;
  std::istringstream lines(dat);
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, head.size(), head) != 0) continue;
    const std::size_t at = line.find(middle, head.size());
    if (at == std::string::npos) refuse(line);
    CcxTotal total;
    total.set = line.substr(head.size(), at - head.size());
    std::istringstream time(line.substr(at + middle.size()));
    total.time = number(time, line);
    std::string forces;
    while (std::getline(lines, forces) && forces.find_first_not_of(' ') == std::string::npos) {
    }
    std::istringstream in(forces);
    for (int k = 0; k < 3; ++k) total.force[k] = number(in, forces.empty() ? line : forces);
    totals.push_back(total);
  }
  return totals;
}

}  // namespace palpate::verify
