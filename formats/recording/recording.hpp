// SPDX-License-Identifier: MIT
// Contacts recorded with a real tool on a real body, read from CSV (recording-file.md).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// One instant of a recorded contact; vectors in the body's frame.
struct RecordedRow {
  std::size_t line = 0;                 ///< of the file, from 1
  std::optional<std::int64_t> site;     ///< of the haptic mesh, in place of `point`
  Eigen::Vector3d point{0, 0, 0};       ///< m, where the contact began, on the undeformed surface
  Eigen::Vector3d deflection{0, 0, 0};  ///< m, how far the tool has moved since
  Eigen::Vector3d force{0, 0, 0};       ///< N on the tool
  std::string tool;                     ///< empty: not said
  std::int64_t tool_vertex = 0;
  double weight = 1.0;  ///< >= 0, beside the other rows
};

struct Recording {
  std::vector<RecordedRow> rows;
};

/// Reads a recording strictly: a wrong row is an error, not a guess. Throws Error(io) when the file cannot be read and
/// Error(bad_input) "file:line: ..." for a wrong header, count of fields, number, or range.
Recording read_recording(const std::filesystem::path& file);

}  // namespace palpate
