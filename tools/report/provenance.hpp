// SPDX-License-Identifier: GPL-3.0-or-later
// Inputs with hashes, settings, versions, machine.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "palpate/format/response_view.hpp"
#include "precompute/pipeline/pipeline.hpp"

namespace palpate::report {

/// `inputs`: files beside the scene's own that were read.
nlohmann::ordered_json provenance(const pipeline::Pipeline& pipeline, const runtime::View& view,
                                  const std::vector<std::filesystem::path>& inputs);

}  // namespace palpate::report
