// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/compliance/linear_body.hpp"

#include "formats/io/error.hpp"
#include "precompute/fem/face_shape.hpp"
#include "precompute/fem/matrix/factor.hpp"
#include "precompute/mesh/volume/volume_mesh.hpp"
#include "precompute/solve/contact/settle.hpp"
#include "precompute/solve/pair/contact_size.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace palpate::compliance {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

constexpr double kEdgeGrowth = 0.5;        // of the elements, per distance beyond a site's surroundings
constexpr double kSiteReach = 2;           // edges: radius of a site's surroundings, half of the way to the next site
constexpr double kEnergyTolerance = 1e-9;  // of the settled state, over Young's modulus times the cube of an edge
constexpr int kCells = 4;                  // parts of a face's side: 16 points a face

[[noreturn]] void fail(const std::string& what) { throw Error(ExitCode::numerical, "compliance: " + what); }

mesh::TetMesh mesh_of(const Body& body, const std::vector<Vector3d>& sites, double edge,
                      const LinearBodyOptions& options) {
  const mesh::SizeField size = [&](const Vector3d& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vector3d& site : sites) nearest = std::min(nearest, (site - p).squaredNorm());
    return edge + kEdgeGrowth * std::max(0.0, std::sqrt(nearest) - kSiteReach * edge);
  };
  mesh::VolumeMeshResult made = mesh::mesh_volume(body, size, {}, options.solver.mesh);
  if (!made.usable) fail("the body could not be meshed: " + made.cause);
  return std::move(made.mesh);
}

}  // namespace

struct LinearBody::Impl {
  fem::BlockMatrix hessian;
  std::unique_ptr<fem::Factor> factor;
  Sparse loads;  // free degrees of freedom x 3 sites: P
  double radius = 0;
  std::size_t nodes = 0;

  Impl(const mesh::TetMesh& mesh, const std::vector<char>& fixed) : hessian(mesh, fixed), nodes(mesh.nodes.size()) {}

  void spread(const mesh::TetMesh& mesh, const VectorXd& x, const std::vector<char>& fixed,
              const std::vector<LoadSite>& sites);
};

void LinearBody::Impl::spread(const mesh::TetMesh& mesh, const VectorXd& x, const std::vector<char>& fixed,
                              const std::vector<LoadSite>& sites) {
  std::vector<int> row(mesh.nodes.size(), -1);
  int count = 0;
  for (std::size_t n = 0; n < row.size(); ++n) {
    if (!fixed[n]) row[n] = count++;
  }
  struct Face {
    Vector3d middle, normal;
    double reach;
  };
  std::vector<Face> faces;
  for (const auto& f : mesh.faces) {
    const Vector3d a = x.segment<3>(3 * f[0]), b = x.segment<3>(3 * f[1]), c = x.segment<3>(3 * f[2]);
    const Vector3d middle = (a + b + c) / 3;
    faces.push_back({middle, (b - a).cross(c - a),
                     1.5 * std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()})});
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t s = 0; s < sites.size(); ++s) {
    std::vector<std::pair<std::int32_t, double>> weights;
    double total = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const Face& face = faces[f];
      if ((face.middle - sites[s].point).norm() > radius + face.reach || face.normal.dot(sites[s].normal) <= 0)
        continue;
      for (int i = 0; i < kCells; ++i) {
        for (int j = 0; j < 2 * (kCells - i) - 1; ++j) {
          // The middles of the small triangles that a face is cut into.
          const double up = j % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
          const double a = (i + up) / kCells, b = (j / 2 + up) / kCells;
          const auto shape = fem::face_values(a, b);
          Vector3d at = Vector3d::Zero();
          for (int n = 0; n < 6; ++n) at += shape[n] * x.segment<3>(3 * mesh.faces[f][n]);
          const double share = (at - sites[s].point).squaredNorm() / (radius * radius);
          if (share >= 1) continue;
          const double weight = std::sqrt(1 - share) * face.normal.norm();
          total += weight;
          for (int n = 0; n < 6; ++n) weights.emplace_back(mesh.faces[f][n], weight * shape[n]);
        }
      }
    }
    if (!(total > 0)) fail("no surface of the mesh lies at site " + std::to_string(s));
    for (const auto& [node, weight] : weights) {
      if (row[node] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        entries.emplace_back(3 * row[node] + k, static_cast<int>(3 * s) + k, weight / total);
      }
    }
  }
  loads.resize(3 * count, static_cast<Eigen::Index>(3 * sites.size()));
  loads.setFromTriplets(entries.begin(), entries.end());
}

LinearBody::LinearBody(const Body& body, const std::vector<LoadSite>& sites, const LinearBodyOptions& options) {
  const Body& start = body.stress_free ? *body.stress_free : body;
  const double edge = std::min(options.edge, solve::longest_edge(start, options.solver));
  std::vector<Vector3d> unloaded;
  for (const LoadSite& site : sites) unloaded.push_back(body.material_point(site.point).point);
  const mesh::TetMesh mesh = mesh_of(start, unloaded, edge, options);
  solve::BodyEnergy energy(start, mesh, options.solver.materials);
  if (!energy.held_anywhere()) fail("no node of the mesh is held");
  VectorXd x = energy.rest();
  if (body.prestress.any()) {
    fem::Minimiser minimiser(mesh, energy.fixed());
    const solve::Settled settled =
        solve::settle(energy, minimiser, x, kEnergyTolerance * start.material.young * std::pow(edge, 3));
    if (!settled.reached) fail(settled.cause);
  }
  impl_ = std::make_unique<Impl>(mesh, energy.fixed());
  energy.hessian(x, fem::HessianKind::exact, impl_->hessian);
  const Sparse& matrix = impl_->hessian.matrix();
  impl_->factor = std::make_unique<fem::Factor>(matrix);
  impl_->radius = std::max(options.contact_radius, kLoadEdges * edge);
  impl_->spread(mesh, x, energy.fixed(), sites);
  if (!impl_->factor->factorise_double(matrix)) {
    fail("the body has no stiffness against some motion in the state from which contact starts (it buckles)");
  }
}

LinearBody::~LinearBody() = default;

MatrixXd LinearBody::columns(const std::vector<std::size_t>& sites) const {
  MatrixXd loads(impl_->loads.rows(), static_cast<Eigen::Index>(3 * sites.size()));
  for (std::size_t k = 0; k < sites.size(); ++k) {
    loads.middleCols<3>(static_cast<Eigen::Index>(3 * k)) =
        MatrixXd(impl_->loads.middleCols(static_cast<Eigen::Index>(3 * sites[k]), 3));
  }
  return impl_->loads.transpose() * impl_->factor->solve_all(loads);
}

double LinearBody::load_radius() const { return impl_->radius; }
std::size_t LinearBody::nodes() const { return impl_->nodes; }

}  // namespace palpate::compliance
