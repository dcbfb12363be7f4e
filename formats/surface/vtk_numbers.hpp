// SPDX-License-Identifier: MIT
// What VTK's two kinds of polydata files have in common: types of numbers, and lists of cells.
#pragma once

#include "formats/surface/surface_plain.hpp"

#include <bit>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::detail {

struct VtkType {
  char kind = 'f';  ///< f, i or u
  std::size_t size = 4;
};

/// By the name that a file gives; none: unknown.
std::optional<VtkType> vtk_type(std::string_view name);
std::vector<double> vtk_numbers(std::string_view bytes, const VtkType& type, bool big_endian);

struct VtkCells {
  std::vector<double> offsets;  ///< of the end of every cell
  std::vector<double> connectivity;
  bool strips = false;  ///< of triangles; else polygons
};

/// Appends the cells as polygons of the vertices from `first_vertex` on. Returns the fault in them; empty: none.
std::string add_vtk_cells(PolygonSoup& soup, const VtkCells& cells, std::size_t first_vertex);
/// Returns the fault in the points; empty: none.
std::string vtk_points_fault(const PolygonSoup& soup);

}  // namespace palpate::detail
