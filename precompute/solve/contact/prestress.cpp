// SPDX-License-Identifier: GPL-3.0-or-later
// One solve of the whole body; the clean surface follows the faces of its mesh.
#include "precompute/solve/contact/prestress.hpp"

#include "formats/io/error.hpp"
#include "precompute/fem/face_shape.hpp"
#include "precompute/geometry/feature_normals.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/mesh/volume/volume_mesh.hpp"
#include "precompute/solve/contact/settle.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kSurface = 1.5;     // element edges on the surface, in those of the body's coarse copy
constexpr double kEdgeGrowth = 0.5;  // per depth below it
constexpr double kTolerance = 1e-9;  // of the energy, over Young's modulus times the cube of the elements

[[noreturn]] void fail(const std::string& what) { throw Error(ExitCode::numerical, "prestress: " + what); }

// Displacements of the boundary of a mesh. The walls of cavities and the outside are looked up apart: in a thin wall
// the nearer face may be that of the other side.
class BoundaryMotion {
public:
  BoundaryMotion(const mesh::TetMesh& mesh, const VectorXd& x, bool cavities) : mesh_(mesh), x_(x) {
    std::vector<char> hollow(mesh.nodes.size(), 0);
    for (const fem::MeshFaces& wall : fem::cavity_walls(mesh)) {
      for (const auto& face : wall) {
        for (const std::int32_t n : face) hollow[n] = 1;
      }
    }
    Surface surface;
    surface.vertices.assign(mesh.nodes.begin(), mesh.nodes.begin() + mesh.corner_count);
    for (const auto& face : mesh.faces) {
      if ((hollow[face[0]] != 0) != cavities) continue;
      faces_.push_back(face);
      surface.triangles.push_back({face[0], face[1], face[2]});
    }
    surface.parts.assign(surface.triangles.size(), 0);
    surface.part_names = {"boundary"};
    if (!faces_.empty()) query_ = std::make_unique<geometry::SurfaceQuery>(surface);
  }

  [[nodiscard]] Vector3d at(const Vector3d& point) const {
    if (!query_) fail("a wall of the body has no faces in its mesh");
    const auto& face = faces_[std::size_t(query_->closest(point).triangle)];
    const geometry::TrianglePoint on =
        geometry::closest_on_triangle(point, mesh_.nodes[face[0]], mesh_.nodes[face[1]], mesh_.nodes[face[2]]);
    const auto shape = fem::face_values(on.weights[0], on.weights[1]);
    Vector3d motion = Vector3d::Zero();
    for (std::size_t n = 0; n < 6; ++n) motion += shape[n] * (x_.segment<3>(3 * face[n]) - mesh_.nodes[face[n]]);
    return motion;
  }

private:
  const mesh::TetMesh& mesh_;
  const VectorXd& x_;
  std::vector<std::array<std::int32_t, 6>> faces_;
  std::unique_ptr<geometry::SurfaceQuery> query_;
};

Surface moved(const Surface& surface, const Body& body, const BoundaryMotion& outside, const BoundaryMotion& cavities) {
  Surface result = surface;
  for (Vector3d& v : result.vertices) v += (body.in_cavity(v) ? cavities : outside).at(v);
  return result;
}

std::string summary(const Body& body, const Surface& after, const Settled& settled, double cavity_before,
                    double cavity_after) {
  double furthest = 0;
  const Surface& before = body.query->surface();
  for (std::size_t v = 0; v < after.vertices.size(); ++v)
    furthest = std::max(furthest, (after.vertices[v] - before.vertices[v]).norm());
  char text[200];
  int used = std::snprintf(text, sizeof text, "prestress: moves the surface by up to %.3g mm, least det F %.3g",
                           1e3 * furthest, settled.min_jacobian);
  if (cavity_before > 0)
    std::snprintf(text + used, sizeof text - std::size_t(used), ", cavities from %.4g to %.4g mL", 1e6 * cavity_before,
                  1e6 * cavity_after);
  return text;
}

}  // namespace

Body apply_prestress(Body body) {
  if (!body.prestress.any()) return body;
  const geometry::SurfaceQuery& query = *body.query;
  const double edge = kSurface * body.base_size;
  const mesh::SizeField size = [&](const Vector3d& p) {
    return edge + kEdgeGrowth * std::max(0.0, -query.signed_distance(p));
  };
  const mesh::VolumeMeshResult made = mesh::mesh_volume(body, size, {});
  if (!made.usable) fail("the body could not be meshed: " + made.cause);
  const mesh::TetMesh& mesh = made.mesh;

  BodyEnergy energy(body, mesh);
  if (!energy.held_anywhere()) fail("no node of the mesh is held");
  fem::Minimiser minimiser(mesh, energy.fixed());
  VectorXd x = energy.rest();
  const Settled settled = settle(energy, minimiser, x, kTolerance * body.material.young * std::pow(edge, 3));
  if (!settled.reached) fail(settled.cause);

  const BoundaryMotion outside(mesh, x, false), cavities(mesh, x, true);
  Body loaded = body;
  const Surface surface = moved(query.surface(), body, outside, cavities);
  if (geometry::self_intersects(surface)) fail("the surface that it leaves crosses itself");
  loaded.query = std::make_shared<const geometry::SurfaceQuery>(surface);
  loaded.base = moved(body.base, body, outside, cavities);
  loaded.report.findings.push_back(
      summary(body, surface, settled, energy.cavity_volume(energy.rest()), energy.cavity_volume(x)));
  loaded.stress_free = std::make_shared<const Body>(std::move(body));
  return loaded;
}

}  // namespace palpate::solve
