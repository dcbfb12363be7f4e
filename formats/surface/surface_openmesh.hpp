// SPDX-License-Identifier: MIT
// Plain triangle soups through OpenMesh's writers, without its half-edge structure in between.
#pragma once

#include "formats/surface/surface.hpp"

#include <string>

namespace palpate {

/// The bytes of a surface file with this extension (".obj", ".off", ".stl" or ".ply"), STL in binary.
/// Throws Error(bad_input) when OpenMesh cannot write it.
std::string write_with_openmesh(const Surface& surface, const std::string& extension);

}  // namespace palpate
