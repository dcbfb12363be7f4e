// SPDX-License-Identifier: GPL-3.0-or-later
// Response files for comparisons with solves of several tools at once: of a scene, or of a block that is solved here.
#pragma once

#include "palpate/math/pose.hpp"
#include "precompute/solve/reference/together.hpp"
#include "tools/cli/contact_case.hpp"
#include "tools/cli/response_input.hpp"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace palpate::cli {

/// A block 40 contact radii wide and 20 deep, shallow enough for Hertz' law.
inline constexpr double kBlockHalf = 0.02, kBlockRadius = 0.01, kBlockDepth = 1e-4;  // m

/// Response files of a block or slab. Each solve has a file with the push of its own mesh at every site, so that the
/// mesh's error is not that of the compliance.
class BlockResponse {
public:
  /// Bakes the compliance: seconds.
  explicit BlockResponse(const ContactCase& contacts);

  /// `solved`: of a tool whose push has at least two depths.
  [[nodiscard]] std::vector<std::byte> file(const solve::TogetherResult& solved);

private:
  pipeline::Pipeline pipeline_;
  ResponseCompliance compliance_;
};

/// The scene's response file (`response`, or NAME.palp beside the scene). Throws Error(bad_input) where it has no
/// compliance.
std::unique_ptr<ResponseInput> response_with_compliance(const std::string& scene, const std::string& response);

runtime::Pose to_pose(const Eigen::Isometry3d& pose);

}  // namespace palpate::cli
