// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/play/frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "formats/fields/surface_fields.hpp"
#include "formats/io/error.hpp"
#include "palpate/shared/dent.hpp"

namespace palpate::cli {
namespace {

using runtime::Vec3;

struct Drawn {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Every triangle in four, by the middles of its edges.
Drawn finer(const Drawn& coarse) {
  Drawn fine{coarse.points, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.points.size()));
    if (fresh) fine.points.push_back(0.5 * (coarse.points[a] + coarse.points[b]));
    return at->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

/// The contact surface, in triangles finer than half a contact as far as `most` vertices allow.
Drawn contact_surface(const runtime::View& view, std::size_t most) {
  constexpr std::size_t kGrowth = 4;  // of the vertices
  Drawn drawn;
  for (std::uint32_t v = 0; v < view.meta->vertex_count; ++v) drawn.points.push_back(runtime::vertex(view, v));
  double longest = 0;
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    const auto& v = view.triangle(t).vertex;
    drawn.triangles.push_back({v[0], v[1], v[2]});
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, length(drawn.points[v[k]] - drawn.points[v[(k + 1) % 3]]));
    }
  }
  while (longest > 0.5 * view.meta->depth_scale && kGrowth * drawn.points.size() <= most) {
    drawn = finer(drawn);
    longest *= 0.5;
  }
  return drawn;
}

SurfaceFields picture(const Drawn& drawn, const std::vector<Vec3>& moved) {
  SurfaceFields surface;
  surface.triangles = drawn.triangles;
  std::vector<Vec3> normals(moved.size());
  for (const auto& [a, b, c] : drawn.triangles) {
    const Vec3 n = cross(moved[b] - moved[a], moved[c] - moved[a]);
    for (const std::uint32_t v : {a, b, c}) normals[v] = normals[v] + n;
  }
  SurfaceField displacement{"displacement", "m", {}};
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const Vec3 n = unit(normals[k], {0, 0, 1});
    surface.points.push_back({float(moved[k].x), float(moved[k].y), float(moved[k].z)});
    surface.normals.push_back({float(n.x), float(n.y), float(n.z)});
    displacement.values.push_back(float(length(moved[k] - drawn.points[k])));
  }
  surface.fields.push_back(std::move(displacement));
  return surface;
}

std::string frame_name(std::size_t frame) {
  char name[32];
  std::snprintf(name, sizeof name, "frame-%05zu.glb", frame);
  return name;
}

}  // namespace

std::size_t write_frames(const runtime::View& view, std::uint32_t tool, const std::vector<MotionRow>& motion,
                         const std::vector<PlayedRow>& rows, const DentFrames& options) {
  if (!view.has(layout::feature_compliance)) {
    throw Error(ExitCode::bad_input, "--frames: the response file has no compliance; add [compliance] to its scene");
  }
  const double begin = motion.front().time, seconds = motion.back().time - begin;
  const auto frames = static_cast<std::size_t>(std::floor(seconds * options.rate)) + 1;
  if (frames > options.most_frames) {
    throw Error(ExitCode::bad_input, "--frames: the motion has " + std::to_string(frames) + " frames; allowed " +
                                         std::to_string(options.most_frames));
  }
  std::error_code failed;
  std::filesystem::create_directories(options.folder, failed);
  if (failed) throw Error(ExitCode::io, options.folder.string() + ": " + failed.message());
  const Drawn drawn = contact_surface(view, options.most_vertices);
  runtime::Dent dent(view);
  dent.bind(drawn.points.data(), drawn.points.size());
  std::vector<Vec3> moved(drawn.points.size());
  std::size_t row = 0;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const double time = begin + static_cast<double>(frame) / options.rate;
    while (row + 1 < rows.size() && rows[row + 1].time <= time) ++row;
    runtime::Dents dents;
    dents.add(view, rows[row].tick, pose_between(motion[row], motion[row], 1), tool);
    dent.apply(dents, moved.data());
    SurfaceFields surface = picture(drawn, moved);
    surface.numbers = {{"time", rows[row].time}, {"force", length(rows[row].tick.force)}};
    write_glb(surface, "displacement", options.folder / frame_name(frame));
  }
  // An earlier, longer motion left them.
  for (std::size_t frame = frames; std::filesystem::remove(options.folder / frame_name(frame), failed); ++frame) {
  }
  return frames;
}

}  // namespace palpate::cli
