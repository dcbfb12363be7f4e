// SPDX-License-Identifier: GPL-3.0-or-later
// Which points of the surface the supports hold, and what is refused.
#include "precompute/surface/supports.hpp"

#include "formats/io/error.hpp"
#include "precompute/algebra/spectrum.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/surface/pieces.hpp"
#include "precompute/surface/repair/weld.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <set>

namespace palpate::surface {
namespace {

[[noreturn]] void refuse_support(const std::string& message) { throw Error(ExitCode::bad_input, message); }

std::string list_of(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

std::string coordinates(const Eigen::Vector3d& p) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x(), p.y(), p.z());
}

// A support may lie inside one triangle: pieces of this many to the body's diagonal find it.
constexpr double kPieces = 64;

// Calls use(a, b, c) for pieces of a triangle of the body's surface.
template <class Use>
void for_each_piece(const Body& body, const Surface& surface, const std::array<std::int32_t, 3>& t, const Use& use) {
  surface::for_each_piece(surface.vertices[std::size_t(t[0])], surface.vertices[std::size_t(t[1])],
                          surface.vertices[std::size_t(t[2])], body.diagonal / kPieces, use);
}

Eigen::AlignedBox3d bounds(const Surface& surface) {
  Eigen::AlignedBox3d box;
  for (const auto& vertex : surface.vertices) box.extend(vertex);
  return box;
}

std::vector<std::string> present_parts(const Surface& surface) {
  std::set<std::string> names;
  for (const auto part : surface.parts) names.insert(surface.part_names[std::size_t(part)]);
  return {names.begin(), names.end()};
}

bool holds(const Body& body, std::size_t k, const Eigen::Vector3d& point) {
  const auto& support = body.supports[k];
  switch (support.kind) {
    case SupportScene::Kind::mesh: {
      const auto& surface = body.query->surface();
      const auto part = surface.parts[std::size_t(body.query->closest(point).triangle)];
      return surface.part_names[std::size_t(part)] == support.mesh;
    }
    case SupportScene::Kind::box:
      return (point.array() >= support.box_min.array()).all() && (point.array() <= support.box_max.array()).all();
    case SupportScene::Kind::half_space:
      return (point - support.point).dot(support.normal) <= 0.0;
    case SupportScene::Kind::distance:
      return body.support_surfaces[k]->closest(point).distance <= support.within;
  }
  return false;
}

// How the supports resist rigid motions (translation, then rotation about `centre` times `length`): the sum over the
// surface's pieces and their corners of what one displacement there costs, over their area.
Eigen::Matrix<double, 6, 6> resistance(const Body& body, const Surface& surface, const Eigen::Vector3d& centre,
                                       double length) {
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  const auto add = [&](const Eigen::Vector3d& at, const Eigen::Vector3d& area) {
    const SupportScene* support = body.support_at(at);
    if (support == nullptr) return;
    const Eigen::Vector3d r = (at - centre) / length;
    Eigen::Matrix<double, 3, 6> motion;
    motion << Eigen::Matrix3d::Identity(), Eigen::Vector3d::UnitX().cross(r), Eigen::Vector3d::UnitY().cross(r),
        Eigen::Vector3d::UnitZ().cross(r);
    const Eigen::Vector3d n = area.normalized();
    const Eigen::Matrix3d across =
        support->type == SupportScene::Type::slider ? Eigen::Matrix3d(n * n.transpose()) : Eigen::Matrix3d::Identity();
    sum += area.norm() * motion.transpose() * across * motion;
  };
  for (const auto& t : surface.triangles) {
    for_each_piece(body, surface, t, [&](const auto& a, const auto& b, const auto& c) {
      const Eigen::Vector3d area = (b - a).cross(c - a) / 8;
      add((a + b + c) / 3, area);
      // Corners count where they are fixed as nodes; beds and sliders hold faces.
      for (const Eigen::Vector3d& corner : {a, b, c}) {
        const SupportScene* support = body.support_at(corner);
        if (support != nullptr && support->type == SupportScene::Type::fixed) add(corner, area);
      }
    });
  }
  return sum;
}

// The rigid motion that nothing resists, in words; empty where there is none.
std::string free_motion(const Body& body, const Surface& surface) {
  const auto box = bounds(surface);
  const auto sum = resistance(body, surface, box.center(), box.diagonal().norm());
  const auto eigen = algebra::spectrum<Eigen::Dynamic>(sum);
  if (eigen.values[0] > 1e-9 * eigen.values[5] && eigen.values[0] > 0) return {};
  const Eigen::Matrix<double, 6, 1> motion = eigen.vectors.col(0);
  const bool slides = motion.head<3>().norm() > motion.tail<3>().norm();
  return (slides ? "slide along " : "turn about the direction ") +
         coordinates((slides ? motion.head<3>() : motion.tail<3>()).normalized());
}

// Every solid must be held somewhere. `held`: whether a part of each triangle is.
void check_components(const Body& body, const std::vector<bool>& held, const Scene& scene) {
  const std::string file = scene.file.string();
  const auto& surface = body.query->surface();
  const auto labels = geometry::triangle_components(surface, true);
  const auto count = *std::max_element(labels.begin(), labels.end()) + 1;
  for (std::int32_t k = 0; k < count; ++k) {
    std::vector<bool> in(labels.size());
    bool any = false;
    for (std::size_t t = 0; t < labels.size(); ++t) {
      in[t] = labels[t] == k;
      any = any || (in[t] && held[t]);
    }
    const Surface component = keep_triangles(surface, in);
    const double volume = geometry::signed_volume(component);
    // The wall of a cavity faces inward and belongs to the solid round it.
    if (volume < 0.0) continue;
    if (any) {
      if (scene.supports.empty()) continue;  // the lowest tenth, fixed: nothing slides
      const std::string motion = free_motion(body, component);
      if (motion.empty()) continue;
      refuse_support(
          fmt::format("{}: the supports leave component {} of {} of the body free to {}", file, k + 1, count, motion));
    }
    refuse_support(
        fmt::format("{}: no support holds component {} of {} of the body ({:.4g} mL round {} m): it would float away. "
                    "Remove it from the file, or hold it by a [[support]]",
                    file, k + 1, count, volume * 1e6, coordinates(bounds(component).center())));
  }
}

}  // namespace

SupportScene default_support(const Surface& surface) {
  const auto box = bounds(surface);
  SupportScene support;
  support.kind = SupportScene::Kind::half_space;
  support.point = {0, 0, box.min().z() + 0.1 * (box.max().z() - box.min().z())};
  support.normal = {0, 0, 1};
  return support;
}

void check_supports(const Body& body, const Scene& scene) {
  const auto& surface = body.query->surface();
  const auto where = [&](std::size_t k) { return fmt::format("{}: support {}", scene.file.string(), k + 1); };
  for (std::size_t k = 0; k < body.supports.size(); ++k) {
    const auto& support = body.supports[k];
    if (support.kind == SupportScene::Kind::mesh) {
      const auto names = present_parts(surface);
      if (std::find(names.begin(), names.end(), support.mesh) == names.end()) {
        refuse_support(where(k) + ": the body has no part named '" + support.mesh + "'; there are: " + list_of(names));
      }
    }
  }
  std::vector<bool> used(body.supports.size(), false), held(surface.triangles.size(), false);
  bool everywhere = true;
  for (std::size_t t = 0; t < held.size(); ++t) {
    for_each_piece(body, surface, surface.triangles[t], [&](const auto& a, const auto& b, const auto& c) {
      bool centre_held = false;
      for (std::size_t k = 0; k < used.size(); ++k) {
        const bool here = holds(body, k, (a + b + c) / 3.0);
        centre_held = centre_held || here;
        if (!here && !holds(body, k, a) && !holds(body, k, b) && !holds(body, k, c)) continue;
        used[k] = held[t] = true;
      }
      everywhere = everywhere && centre_held;
    });
  }
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k]) continue;
    const auto box = bounds(surface);
    refuse_support(fmt::format("{} holds no point of the body, which lies from {} to {} m", where(k),
                               coordinates(box.min()), coordinates(box.max())));
  }
  if (everywhere) {
    refuse_support(scene.file.string() + ": the supports hold the whole surface: nothing is left to touch");
  }
  check_components(body, held, scene);
}

}  // namespace palpate::surface

namespace palpate {

const SupportScene* Body::support_at(const Eigen::Vector3d& surface_point) const {
  if (stress_free) return stress_free->support_at(material_point(surface_point).point);
  for (std::size_t k = 0; k < supports.size(); ++k) {
    if (surface::holds(*this, k, surface_point)) return &supports[k];
  }
  return nullptr;
}

}  // namespace palpate
