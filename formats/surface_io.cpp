// SPDX-License-Identifier: MIT
// Reading by extension with what is checked for every format, and writing whole or not at all.
#include "formats/surface_io.hpp"

#include "formats/error.hpp"
#include "formats/file.hpp"
#include "formats/surface_gltf.hpp"
#include "formats/surface_openmesh.hpp"
#include "formats/surface_screen.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

std::string extension_of(const std::filesystem::path& file) {
  auto extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// Refuses what a reader of OpenMesh delivers when it differs from what the screen saw in the file.
void check_against(const PolygonSoup& soup, const SurfaceCensus& census, bool welded,
                   const std::filesystem::path& file) {
  Eigen::AlignedBox3d bounds;
  for (const auto& vertex : soup.vertices) bounds.extend(vertex);
  const auto scale = std::max(census.bounds.min().cwiseAbs().maxCoeff(), census.bounds.max().cwiseAbs().maxCoeff());
  const bool same_count = welded || soup.vertices.size() == census.vertices;
  if (!same_count || std::size_t(soup.polygon_count) != census.polygons ||
      !((bounds.min() - census.bounds.min()).cwiseAbs().maxCoeff() <= 1e-6 * scale) ||
      !((bounds.max() - census.bounds.max()).cwiseAbs().maxCoeff() <= 1e-6 * scale)) {
    throw Error(ExitCode::bad_input, file.string() + ": OpenMesh read " + std::to_string(soup.vertices.size()) +
                                         " vertices and " + std::to_string(soup.polygon_count) +
                                         " faces where the file has " + std::to_string(census.vertices) + " and " +
                                         std::to_string(census.polygons));
  }
  const auto count = static_cast<std::int32_t>(soup.vertices.size());
  for (const auto& triangle : soup.triangles) {
    for (const auto vertex : triangle) {
      if (vertex < 0 || vertex >= count) {
        throw Error(ExitCode::bad_input, file.string() + ": vertex index " + std::to_string(vertex) +
                                             " is outside 0.." + std::to_string(count - 1));
      }
    }
  }
}

[[noreturn]] void missing_name(const std::string& name, const std::vector<std::string>& names,
                               const std::filesystem::path& file) {
  std::string list;
  for (const auto& known : names) list += (list.empty() ? "" : ", ") + known;
  throw Error(ExitCode::bad_input, file.string() + ": no mesh named '" + name + "'; there are: " + list);
}

// Keeps the triangles of the wanted parts, and the vertices they use.
Surface select_parts(const Surface& all, const std::vector<std::string>& wanted, const std::filesystem::path& file) {
  std::vector<bool> keep(all.part_names.size(), false);
  for (const auto& name : wanted) {
    const auto found = std::find(all.part_names.begin(), all.part_names.end(), name);
    if (found == all.part_names.end()) missing_name(name, all.part_names, file);
    keep[std::size_t(found - all.part_names.begin())] = true;
  }
  Surface selected;
  std::vector<std::int32_t> new_part(keep.size(), -1), new_vertex(all.vertices.size(), -1);
  for (std::size_t part = 0; part < keep.size(); ++part) {
    if (!keep[part]) continue;
    new_part[part] = static_cast<std::int32_t>(selected.part_names.size());
    selected.part_names.push_back(all.part_names[part]);
  }
  for (std::size_t t = 0; t < all.triangles.size(); ++t) {
    const auto part = std::size_t(all.parts[t]);
    if (!keep[part]) continue;
    auto triangle = all.triangles[t];
    for (auto& vertex : triangle) {
      auto& number = new_vertex[std::size_t(vertex)];
      if (number < 0) {
        number = static_cast<std::int32_t>(selected.vertices.size());
        selected.vertices.push_back(all.vertices[std::size_t(vertex)]);
      }
      vertex = number;
    }
    selected.triangles.push_back(triangle);
    selected.parts.push_back(new_part[part]);
  }
  return selected;
}

Surface read_plain(const SurfaceSource& source, const std::string& extension, const std::string& bytes) {
  const auto& file = source.file;
  SurfaceCensus census = extension == ".obj"   ? screen_obj(bytes, file)
                         : extension == ".off" ? screen_off(bytes, file)
                         : extension == ".stl" ? screen_stl(bytes, file)
                                               : screen_ply(bytes, file);
  if (census.polygons == 0) throw Error(ExitCode::bad_input, file.string() + ": there are no triangles in it");
  auto soup = read_with_openmesh(census.plain.empty() ? bytes : census.plain, file, extension, census.binary);
  check_against(soup, census, extension == ".stl", file);
  Surface surface;
  surface.vertices = std::move(soup.vertices);
  surface.triangles = std::move(soup.triangles);
  if (census.group_names.empty()) {
    surface.part_names = {file.stem().string()};
    surface.parts.assign(surface.triangles.size(), 0);
  } else {
    surface.part_names = census.group_names;
    for (const auto polygon : soup.polygons) surface.parts.push_back(census.groups[std::size_t(polygon)]);
  }
  return source.meshes.empty() ? surface : select_parts(surface, source.meshes, file);
}

}  // namespace

Surface read_surface(const SurfaceSource& source) {
  const auto extension = extension_of(source.file);
  const bool gltf = extension == ".glb" || extension == ".gltf";
  if (!gltf && extension != ".obj" && extension != ".off" && extension != ".stl" && extension != ".ply") {
    throw Error(ExitCode::bad_input, source.file.string() + ": unknown surface format '" + extension +
                                         "' (allowed: .glb, .gltf, .obj, .stl, .ply, .off)");
  }
  if (!std::isfinite(source.unit) || source.unit <= 0) {
    throw Error(ExitCode::bad_input, source.file.string() + ": the unit must be a positive number of metres");
  }
  const auto bytes = read_file(source.file, "surface", std::numeric_limits<std::int32_t>::max());
  if (bytes.empty()) throw Error(ExitCode::bad_input, source.file.string() + ": the file is empty");
  Surface surface =
      gltf ? read_gltf(bytes, source.file, source.meshes, extension == ".glb") : read_plain(source, extension, bytes);
  if (surface.empty()) throw Error(ExitCode::bad_input, source.file.string() + ": there are no triangles in it");
  for (auto& vertex : surface.vertices) vertex *= source.unit;
  return surface;
}

void write_surface(const Surface& surface, const std::filesystem::path& path) {
  const auto extension = extension_of(path);
  if (extension != ".obj" && extension != ".off" && extension != ".stl" && extension != ".ply") {
    throw Error(ExitCode::bad_input,
                path.string() + ": cannot write '" + extension + "' (allowed: .ply, .off, .obj, .stl)");
  }
  const auto count = static_cast<std::int32_t>(surface.vertices.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const auto vertex : surface.triangles[t]) {
      if (vertex < 0 || vertex >= count) {
        throw Error(ExitCode::bad_input, path.string() + ": triangle " + std::to_string(t) + ": vertex index " +
                                             std::to_string(vertex) + " is outside 0.." + std::to_string(count - 1));
      }
    }
  }
  write_file(path, write_with_openmesh(surface, extension));
}

}  // namespace palpate
