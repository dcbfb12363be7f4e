// SPDX-License-Identifier: GPL-3.0-or-later
// Warnings of a scene that can be solved but is seldom meant.
#pragma once

#include <string>
#include <vector>

#include "formats/scene/scene.hpp"
#include "precompute/common/body.hpp"

namespace palpate::pipeline {

/// One line each, with the figures and the key that changes it: a push deeper than the walls allow, supports that
/// leave a long body standing on a small foot.
std::vector<std::string> scene_warnings(const Scene& scene, const Body& body);

}  // namespace palpate::pipeline
