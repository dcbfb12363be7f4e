// SPDX-License-Identifier: MIT
// A triangle surface with numbers at its vertices, written for viewers: GLB with colours, VTK's .vtu with scalars.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// One number a vertex.
struct SurfaceField {
  std::string name;  ///< lower-case letters and underscores
  std::string unit;  ///< as text, "N/m"; empty for a share
  std::vector<float> values;
  /// Smallest and largest value. At least one value.
  [[nodiscard]] std::pair<float, float> range() const;
};

/// In metres. All lists of points are of the same length; everything is finite.
struct SurfaceFields {
  std::vector<std::array<float, 3>> points, normals;  ///< normals outward, of length 1
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<SurfaceField> fields;
  std::vector<std::pair<std::string, double>> numbers;  ///< what holds for the whole: names as a field's
};

/// Colour of a share in [0, 1] of a field's range, from dark blue over green to yellow (matplotlib's viridis, CC0);
/// red, green, blue in linear light, as glTF wants them.
std::array<std::uint8_t, 4> field_colour(double share);

/// One mesh, coloured by the field of that name; every field is a vertex attribute too, "_" and its name in capitals,
/// its unit in the accessor's name; `numbers` are the asset's extras. Throws Error(bad_input) when it does not fit the
/// format's 2 GiB or has no such field, Error(io) when the file cannot be written whole.
void write_glb(const SurfaceFields& surface, const std::string& shown, const std::filesystem::path& path);

/// VTK's XML unstructured grid, as text; ParaView shows the field of that name first, the normals are there too and
/// `numbers` are field data. Throws as write_glb, without the limit of size.
void write_vtu(const SurfaceFields& surface, const std::string& shown, const std::filesystem::path& path);

}  // namespace palpate
