// SPDX-License-Identifier: GPL-3.0-or-later
// A picture of a surface with a field on it, drawn without a graphics card or a display.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/fields/surface_fields.hpp"

namespace palpate::cli {

struct PictureOptions {
  int width = 960, height = 640;  ///< pixels, [64, 8192]
  double azimuth = -59;           ///< degrees, of the camera about +z from +x, any
  double elevation = 30;          ///< degrees, of the camera above the xy plane, [-90, 90]
  std::optional<std::string> validate() const;
};

/// 8-bit RGB, rows from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// The surface in perspective before white, coloured by the field of that name (viridis over the field's range), with a
/// colour bar that has the field's name, unit and ends. Throws Error(bad_input) where the surface has no such field,
/// Error(usage) where the options are out of range.
Picture draw_surface(const SurfaceFields& surface, const std::string& shown, const PictureOptions& options = {});

/// The picture as the bytes of a PNG file.
std::string png_bytes(const Picture& picture);

}  // namespace palpate::cli
