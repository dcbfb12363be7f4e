// SPDX-License-Identifier: GPL-3.0-or-later
// A feature of a response file: its bytes and equilibria, and the same file with and without it.
#pragma once

#include <optional>

#include "formats/response/response.hpp"
#include "palpate/format/response_view.hpp"
#include "precompute/pipeline/pipeline.hpp"

namespace palpate::cli {

/// The same content with the feature. A feature that it has not is added in the form of a usual fit: degrees of 3,
/// tangential biases of zero, a friction coefficient of 0.3 with a tangential stiffness as large as the normal one,
/// a softening of a tenth. The time of a tick depends on the form, not on these values. `feature`: tangential bias,
/// friction, slip softening or search.
ResponseFileContent with_feature(ResponseFileContent content, layout::Feature feature);

/// The same content without the feature, as above. A file without friction has no slip softening either.
ResponseFileContent without_feature(ResponseFileContent content, layout::Feature feature);

/// Bytes of a response that the feature takes or, in the form of a usual fit, would take.
double feature_bytes(const layout::Meta& meta, layout::Feature feature);

/// Equilibria that the feature takes or would take over all pairs that are solved in full, by their paths. Empty where
/// the plan does not show them: tool patches, spins, compliance.
std::optional<double> feature_solves(const pipeline::Pipeline& pipeline, layout::Feature feature);

}  // namespace palpate::cli
