// SPDX-License-Identifier: MIT
// Reading by extension with what is checked for every format, and writing whole or not at all.
#include "formats/surface/surface_io.hpp"

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/surface/surface_gltf.hpp"
#include "formats/surface/surface_openmesh.hpp"
#include "formats/surface/surface_plain.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>

namespace palpate {
namespace {

std::string extension_of(const std::filesystem::path& file) {
  auto extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

constexpr double kCoarsest = 5e-4;         // of the diagonal: coordinates of coarser steps have lost the shape
constexpr double kFar = 100;               // diagonals from the origin: nearer, coarse steps are the shape's own
constexpr std::size_t kFewVertices = 100;  // boxes and the like may well have whole coordinates

// Refuses coordinates far from the origin whose digits do not suffice for the shape.
void check_digits(const PolygonSoup& soup, const std::filesystem::path& file) {
  Eigen::AlignedBox3d bounds;
  for (const auto& vertex : soup.vertices) bounds.extend(vertex);
  if (bounds.isEmpty()) return;
  const double diagonal = bounds.diagonal().norm();
  const double largest = std::max(bounds.min().cwiseAbs().maxCoeff(), bounds.max().cwiseAbs().maxCoeff());
  if (!(largest > kFar * diagonal)) return;
  double step = soup.single ? largest * 0x1p-23 : 0;
  if (soup.decimals >= 0 && soup.decimals < 20 && soup.vertices.size() >= kFewVertices) {
    step = std::max(step, std::pow(10.0, -soup.decimals));
  }
  if (!(step > kCoarsest * diagonal)) return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      ": lies %.3g from the origin, where its numbers have steps of %.2g; its size is %.3g. The shape is lost "
      "in the file: move it to the origin before it is saved",
      largest, step, diagonal);
  throw Error(ExitCode::bad_input, file.string() + text);
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
  selected.frame = all.frame;
  selected.notes = all.notes;
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

PolygonSoup read_polygons(const std::string& extension, const std::string& bytes, const std::filesystem::path& file) {
  if (extension == ".obj") return read_obj(bytes, file);
  if (extension == ".off") return read_off(bytes, file);
  if (extension == ".stl") return read_stl(bytes, file);
  if (extension == ".vtk") return read_vtk(bytes, file);
  if (extension == ".vtp") return read_vtp(bytes, file);
  return read_ply(bytes, file);
}

Surface read_plain(const SurfaceSource& source, const std::string& extension, const std::string& bytes) {
  const auto& file = source.file;
  PolygonSoup soup = read_polygons(extension, bytes, file);
  if (soup.polygons() == 0) throw Error(ExitCode::bad_input, file.string() + ": there are no triangles in it");
  check_digits(soup, file);
  Surface surface;
  surface.vertices = std::move(soup.vertices);
  surface.frame = soup.frame;
  surface.notes = std::move(soup.notes);
  surface.part_names = soup.group_names;
  if (surface.part_names.empty()) surface.part_names = {file.stem().string()};
  for (std::size_t p = 0; p < soup.polygons(); ++p) {
    const auto part = soup.groups.empty() ? 0 : soup.groups[p];
    for (const auto& triangle :
         triangles_of(surface.vertices, soup.corners.data() + soup.first[p], soup.first[p + 1] - soup.first[p])) {
      surface.triangles.push_back(triangle);
      surface.parts.push_back(part);
    }
  }
  return source.meshes.empty() ? surface : select_parts(surface, source.meshes, file);
}

bool is_plain(const std::string& extension) {
  return extension == ".obj" || extension == ".off" || extension == ".stl" || extension == ".ply" ||
         extension == ".vtk" || extension == ".vtp";
}

}  // namespace

Surface read_surface(const SurfaceSource& source) {
  const auto extension = extension_of(source.file);
  const bool gltf = extension == ".glb" || extension == ".gltf";
  if (!gltf && !is_plain(extension)) {
    throw Error(ExitCode::bad_input, source.file.string() + ": unknown surface format '" + extension +
                                         "' (allowed: .glb, .gltf, .obj, .stl, .ply, .off, .vtp, .vtk)");
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
