// SPDX-License-Identifier: GPL-3.0-or-later
// The contents of a response file as `palpate inspect` lists them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "palpate/format/response_view.hpp"

namespace palpate::cli {

struct FeatureName {
  layout::Feature bit;
  const char* name;
  const char* without;  ///< what a file without it cannot do
};
const std::vector<FeatureName>& feature_names();

/// Sections, features, counts, degrees and provenance of a response file; `file` is its name.
nlohmann::ordered_json contents_of(const runtime::View& view, const std::string& file);

}  // namespace palpate::cli
