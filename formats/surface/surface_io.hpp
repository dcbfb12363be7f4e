// SPDX-License-Identifier: MIT
// Reads triangle surfaces: glTF/GLB (tinygltf), OBJ, STL, PLY, OFF, VTK's .vtp and .vtk; writes some (OpenMesh).
#pragma once

#include "formats/scene/scene.hpp"
#include "formats/surface/surface.hpp"

#include <filesystem>

namespace palpate {

/// Reads the meshes of `source.meshes` (all when empty) into one triangle soup in metres, one part for
/// every mesh. glTF: a name is a mesh's, or a node's; a node without a mesh of its own stands for all
/// below it; node transforms are applied. OBJ: a name is a group's or an object's. Others: the file's stem.
/// Vertices at exactly the same place are merged within a part in glTF and STL, whose formats split them;
/// other formats keep their vertices. Polygons become triangles that cover them once. Coordinates stay in double
/// precision; far from the origin, numbers of too few digits for the shape are refused. The frame is set where a
/// comment of 3D Slicer's states it.
/// Throws Error(io) when the file cannot be read; Error(bad_input), naming file and line or element, for an
/// unknown extension, a truncated or damaged file, NaN or infinite coordinates, an index out of range, a
/// missing name (the message lists the names there are) and a file without triangles.
Surface read_surface(const SurfaceSource& source);

/// Writes .ply, .off, .obj or .stl (by extension), in metres; parts are not kept. The file appears whole or
/// not at all. Throws Error(bad_input) for another extension or an index out of range, Error(io) when the
/// file cannot be written whole.
void write_surface(const Surface& surface, const std::filesystem::path& path);

}  // namespace palpate
