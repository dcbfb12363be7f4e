// SPDX-License-Identifier: GPL-3.0-or-later
// Puts geometry, tools, fitted responses and provenance together into the content of a response file.
#pragma once

#include <vector>

#include "formats/io/hash.hpp"
#include "formats/response/response.hpp"
#include "precompute/fit/fit.hpp"
#include "precompute/mesh/surface/contact_surface.hpp"

namespace palpate::fit {

/// `manifest`: the hash that the journal carries, recorded in the provenance. The same inputs give the same content:
/// it holds no time and no path.
ResponseFileContent assemble_response(const Scene& scene, const std::vector<tool::Tool>& tools,
                                      const mesh::ContactSurface& contact, const bake::Plan& plan,
                                      const Hash128& manifest, const FittedResponses& fitted,
                                      const PairSources& sources = {});

}  // namespace palpate::fit
