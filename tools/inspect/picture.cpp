// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/inspect/picture.hpp"

#include <zlib.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "formats/io/error.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
namespace {
/// The encoder's own compression makes files of twice the size.
unsigned char* compress_by_zlib(unsigned char* data, int size, int* compressed, int /*quality*/) {
  uLongf length = ::compressBound(uLong(size));
  auto* bytes = static_cast<unsigned char*>(std::malloc(length));
  if (bytes == nullptr || ::compress2(bytes, &length, data, uLong(size), Z_BEST_COMPRESSION) != Z_OK) {
    std::free(bytes);
    return nullptr;
  }
  *compressed = int(length);
  return bytes;
}
}  // namespace
#define STBIW_ZLIB_COMPRESS compress_by_zlib
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_easy_font.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace palpate::cli {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kOver = 3;                                ///< samples along each axis of a pixel
constexpr double kField = 32 * std::numbers::pi / 180;  ///< rad, vertical angle of view
constexpr double kInk = 0.13;                           ///< grey of text

/// Linear light to sRGB (IEC 61966-2-1), both in [0, 1].
double encoded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

Vector3d colour_at(double share) {
  const auto c = field_colour(std::clamp(share, 0.0, 1.0));
  return {encoded(c[0] / 255.0), encoded(c[1] / 255.0), encoded(c[2] / 255.0)};
}

/// sRGB of a canvas with several samples a pixel, and the depth of each.
struct Canvas {
  int width, height;
  std::vector<Vector3d> colours;
  std::vector<double> depths;
  Canvas(int w, int h)
      : width(w),
        height(h),
        colours(std::size_t(w) * std::size_t(h), Vector3d::Ones()),
        depths(colours.size(), std::numeric_limits<double>::infinity()) {}
  [[nodiscard]] std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
  void fill(double x0, double y0, double x1, double y1, const Vector3d& colour) {
    for (int y = std::max(0, int(y0)); y < std::min(height, int(y1)); ++y) {
      for (int x = std::max(0, int(x0)); x < std::min(width, int(x1)); ++x) colours[at(x, y)] = colour;
    }
  }
};

/// A vertex on the canvas.
struct Projected {
  Vector2d place;      ///< samples
  double inverse = 0;  ///< 1 / depth, which is linear over the canvas
  Vector3d normal;     ///< in the camera's frame
  double share = 0;    ///< of the field's range
};

struct Camera {
  Vector3d right, up, back, eye;
  double focus = 1;          ///< samples
  Vector2d centre = {0, 0};  ///< samples, where the view's axis meets the canvas
  [[nodiscard]] Projected project(const Vector3d& p) const {
    const Vector3d d = p - eye;
    const double depth = -d.dot(back);
    Projected out;
    out.place = centre + focus / depth * Vector2d(d.dot(right), -d.dot(up));
    out.inverse = 1 / depth;
    return out;
  }
  [[nodiscard]] Vector3d turned(const Vector3d& v) const { return {v.dot(right), v.dot(up), v.dot(back)}; }
};

/// A camera that has the whole surface in view: its picture fills the canvas but for the margins.
Camera camera_for(const SurfaceFields& surface, const PictureOptions& options, const Canvas& canvas) {
  constexpr double kMargin = 0.07, kBar = 0.1;  // of the canvas: on every side, and below for the colour bar
  Eigen::AlignedBox3d box;
  for (const auto& p : surface.points) box.extend(Vector3d(p[0], p[1], p[2]));
  const double a = options.azimuth * std::numbers::pi / 180, e = options.elevation * std::numbers::pi / 180;
  Camera camera;
  camera.back = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  camera.right = {-std::sin(a), std::cos(a), 0};
  camera.up = camera.back.cross(camera.right);
  camera.eye = box.center() + 0.5 * box.diagonal().norm() / std::sin(kField / 2) * camera.back;
  Eigen::AlignedBox2d seen;
  for (const auto& p : surface.points) seen.extend(camera.project({p[0], p[1], p[2]}).place);
  const Vector2d room(canvas.width * (1 - 2 * kMargin), canvas.height * (1 - 2 * kMargin - kBar));
  camera.focus = room.cwiseQuotient(seen.sizes().cwiseMax(1e-12)).minCoeff();
  camera.centre = Vector2d(0.5 * canvas.width, (0.5 - 0.5 * kBar) * canvas.height) - camera.focus * seen.center();
  return camera;
}

/// The page's light: a key, a fill, a gloss.
Vector3d shaded(const Vector3d& tint, const Vector3d& normal) {
  const Vector3d key = Vector3d(-0.35, 0.7, 0.65).normalized(), fill = Vector3d(0.8, -0.1, 0.5).normalized();
  const Vector3d half = (key + Vector3d::UnitZ()).normalized();
  const double light = 0.5 + 0.48 * std::max(0.0, normal.dot(key)) + 0.16 * std::max(0.0, normal.dot(fill));
  const double gloss = 0.1 * std::pow(std::max(0.0, normal.dot(half)), 40);
  return (light * tint + Vector3d::Constant(gloss)).cwiseMin(1.0);
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

void draw_triangle(const Projected (&v)[3], Canvas& canvas) {
  const double area = cross(v[1].place - v[0].place, v[2].place - v[0].place);
  if (!(area < 0)) return;  // seen from behind: y points down
  Eigen::AlignedBox2d box;
  for (const Projected& corner : v) box.extend(corner.place);
  for (int y = std::max(0, int(box.min().y())); y <= std::min(canvas.height - 1, int(box.max().y())); ++y) {
    for (int x = std::max(0, int(box.min().x())); x <= std::min(canvas.width - 1, int(box.max().x())); ++x) {
      const Vector2d p(x + 0.5, y + 0.5);
      double w[3];
      bool inside = true;
      for (int k = 0; k < 3; ++k) {
        w[k] = cross(v[(k + 1) % 3].place - p, v[(k + 2) % 3].place - p) / area;
        inside = inside && w[k] >= 0;
      }
      if (!inside) continue;
      const double inverse = w[0] * v[0].inverse + w[1] * v[1].inverse + w[2] * v[2].inverse;
      const std::size_t at = canvas.at(x, y);
      if (1 / inverse >= canvas.depths[at]) continue;
      canvas.depths[at] = 1 / inverse;
      Vector3d normal = Vector3d::Zero();
      double share = 0;
      for (int k = 0; k < 3; ++k) {
        const double part = w[k] * v[k].inverse / inverse;
        normal += part * v[k].normal;
        share += part * v[k].share;
      }
      canvas.colours[at] = shaded(colour_at(share), normal.normalized());
    }
  }
}

/// Draws text with its left upper corner there; `size` samples are a pixel of the font.
void draw_text(Canvas& canvas, double x, double y, double size, std::string text) {
  struct Corner {
    float x, y, z;
    unsigned char colour[4];
  };
  std::vector<Corner> corners(4 * 60 * (text.size() + 1));
  const int quads =
      stb_easy_font_print(0, 0, text.data(), nullptr, corners.data(), int(corners.size() * sizeof(Corner)));
  for (int q = 0; q < quads; ++q) {
    const Corner &low = corners[std::size_t(4 * q)], &high = corners[std::size_t(4 * q + 2)];
    canvas.fill(x + size * double{low.x}, y + size * double{low.y}, x + size * double{high.x},
                y + size * double{high.y}, Vector3d::Constant(kInk));
  }
}
double text_width(std::string text, double size) { return size * stb_easy_font_width(text.data()); }

void draw_bar(Canvas& canvas, const SurfaceField& field, double low, double high) {
  const double size = kOver * std::max(1.0, std::round(canvas.height / (420.0 * kOver)));  // of a pixel of the font
  const double margin = 12 * size, width = 130 * size, thick = 6 * size;
  const double x0 = margin, y1 = canvas.height - margin - 11 * size, y0 = y1 - thick;
  for (int x = 0; x < int(width); ++x) canvas.fill(x0 + x, y0, x0 + x + 1, y1, colour_at(x / width));
  draw_text(canvas, x0, y0 - 12 * size, size, field.name + (field.unit.empty() ? "" : ", " + field.unit));
  for (const double share : {0.0, 0.5, 1.0}) {
    char number[32];
    std::snprintf(number, sizeof number, "%.3g", low + share * (high - low));
    draw_text(canvas, x0 + share * (width - text_width(number, size)), y1 + 3 * size, size, number);
  }
}

}  // namespace

std::optional<std::string> PictureOptions::validate() const {
  if (width < 64 || width > 8192 || height < 64 || height > 8192) {
    return "a picture of " + std::to_string(width) + " x " + std::to_string(height) +
           " pixels; allowed: 64 to 8192 each";
  }
  if (!std::isfinite(azimuth) || !(std::abs(elevation) <= 90)) return "elevation is outside [-90, 90] degrees";
  return {};
}

Picture draw_surface(const SurfaceFields& surface, const std::string& shown, const PictureOptions& options) {
  if (const auto wrong = options.validate()) throw Error(ExitCode::usage, *wrong);
  const auto field = std::find_if(surface.fields.begin(), surface.fields.end(),
                                  [&](const SurfaceField& f) { return f.name == shown; });
  if (field == surface.fields.end()) throw Error(ExitCode::bad_input, "no field '" + shown + "' on the surface");
  const auto [low, high] = field->range();
  const double range = high > low ? double{high} - double{low} : 1;
  Canvas canvas(kOver * options.width, kOver * options.height);
  const Camera camera = camera_for(surface, options, canvas);
  std::vector<Projected> vertices;
  for (std::size_t k = 0; k < surface.points.size(); ++k) {
    const auto &p = surface.points[k], &n = surface.normals[k];
    Projected v = camera.project({p[0], p[1], p[2]});
    v.normal = camera.turned({n[0], n[1], n[2]});
    v.share = (double{field->values[k]} - double{low}) / range;
    vertices.push_back(v);
  }
  for (const auto& t : surface.triangles) draw_triangle({vertices[t[0]], vertices[t[1]], vertices[t[2]]}, canvas);
  draw_bar(canvas, *field, low, high);
  Picture picture{options.width, options.height, {}};
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      Vector3d sum = Vector3d::Zero();
      for (int k = 0; k < kOver * kOver; ++k)
        sum += canvas.colours[canvas.at(kOver * x + k % kOver, kOver * y + k / kOver)];
      for (const double c : sum / (kOver * kOver)) {
        picture.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(c, 0.0, 1.0))));
      }
    }
  }
  return picture;
}

std::string png_bytes(const Picture& picture) {
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), std::size_t(size));
  };
  if (stbi_write_png_to_func(append, &bytes, picture.width, picture.height, 3, picture.rgb.data(), 3 * picture.width) ==
      0) {
    throw Error(ExitCode::io, "the picture cannot be written as PNG");
  }
  return bytes;
}

}  // namespace palpate::cli
