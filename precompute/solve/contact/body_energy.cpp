// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of energies, and where the supports stand at a share of the prestress.
#include "precompute/solve/contact/body_energy.hpp"

#include "formats/io/error.hpp"
#include "precompute/fem/materials/scene_material.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

fem::Material with_fibres(const MaterialScene& scene, const std::shared_ptr<const geometry::CurveQuery>& fibres) {
  fem::Material material = fem::make_material(scene);
  if (fibres) material.fibre_at = [fibres](const Vector3d& place) { return fibres->tangent(place); };
  return material;
}

std::vector<fem::Material> materials(const Body& body) {
  std::vector<fem::Material> all{with_fibres(body.material, body.fibres)};
  for (const Inclusion& i : body.inclusions) all.push_back(with_fibres(i.material, i.fibres));
  return all;
}

VectorXd stacked(const mesh::TetMesh& mesh) {
  VectorXd x(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) x.segment<3>(3 * n) = mesh.nodes[n];
  return x;
}

// Whether most of a wall came from the mesh of that name.
bool comes_from(const Body& body, const mesh::TetMesh& mesh, const fem::MeshFaces& wall, const std::string& name) {
  const Surface& surface = body.query->surface();
  std::size_t count = 0;
  for (const auto& f : wall) {
    const Vector3d middle = (mesh.nodes[f[0]] + mesh.nodes[f[1]] + mesh.nodes[f[2]]) / 3;
    const auto part = surface.parts[std::size_t(body.query->closest(middle).triangle)];
    count += surface.part_names[std::size_t(part)] == name ? 1 : 0;
  }
  return 2 * count > wall.size();
}

fem::PressureEnergy cavity_pressure(const Body& body, const mesh::TetMesh& mesh) {
  const PrestressScene& scene = body.prestress;
  if (!(scene.pressure > 0)) return {mesh, {}, 0.0};
  fem::MeshFaces walls;
  for (const fem::MeshFaces& wall : fem::cavity_walls(mesh)) {
    if (!scene.cavity.empty() && !comes_from(body, mesh, wall, scene.cavity)) continue;
    walls.insert(walls.end(), wall.begin(), wall.end());
  }
  if (walls.empty()) {
    throw Error(ExitCode::bad_input,
                scene.cavity.empty()
                    ? "prestress.pressure: the body has no cavity (a closed wall inside it that "
                      "faces inward) for it to act in"
                    : "prestress.cavity: no wall of a cavity came from the mesh '" + scene.cavity + "'");
  }
  return {mesh, std::move(walls), scene.pressure};
}

VectorXd stretch_of(const Body& body, const VectorXd& rest) {
  if (body.prestress.stretch.isOnes(0)) return {};
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : body.query->surface().vertices) box.extend(v);
  VectorXd motion(rest.size());
  for (Eigen::Index k = 0; k < rest.size(); k += 3) {
    motion.segment<3>(k) = (body.prestress.stretch - Vector3d::Ones()).cwiseProduct(rest.segment<3>(k) - box.center());
  }
  return motion;
}

}  // namespace

std::vector<char> fixed_nodes(const Body& body, const mesh::TetMesh& mesh) {
  std::vector<char> boundary(mesh.nodes.size(), 0), fixed(mesh.nodes.size(), 0);
  for (const auto& face : mesh.faces) {
    for (const std::int32_t n : face) boundary[n] = 1;
  }
  for (std::size_t n = 0; n < fixed.size(); ++n) {
    const SupportScene* support = boundary[n] ? body.support_at(mesh.nodes[n]) : nullptr;
    fixed[n] = support != nullptr && support->type == SupportScene::Type::fixed;
  }
  return fixed;
}

BodyEnergy::BodyEnergy(const Body& body, const mesh::TetMesh& mesh, const std::vector<fem::Material>& given)
    : rest_(stacked(mesh)),
      fixed_(fixed_nodes(body, mesh)),
      elastic_(mesh, given.empty() ? materials(body) : given),
      membrane_(mesh, fixed_, {body.capsule_thickness, body.capsule_young}),
      bed_(body, mesh),
      weight_(mesh, body.prestress.density * body.prestress.gravity),
      pressure_(cavity_pressure(body, mesh)),
      motion_(stretch_of(body, rest_)),
      rest_energy_(elastic_.value(rest_)) {}

void BodyEnergy::set_share(double share) {
  share_ = share;
  if (motion_.size() > 0) bed_.set_foundation(rest_ + share * motion_);
}

void BodyEnergy::hold(VectorXd& x) const {
  for (std::size_t n = 0; n < fixed_.size(); ++n) {
    if (!fixed_[n]) continue;
    const auto k = 3 * static_cast<Eigen::Index>(n);
    x.segment<3>(k) = rest_.segment<3>(k);
    if (motion_.size() > 0) x.segment<3>(k) += share_ * motion_.segment<3>(k);
  }
}

bool BodyEnergy::held_anywhere() const {
  return !bed_.empty() || std::any_of(fixed_.begin(), fixed_.end(), [](char f) { return f != 0; });
}

BodyEnergy::Slope BodyEnergy::slope(const VectorXd& x) const {
  Slope slope;
  slope.forces = weight_.value(x) + pressure_.value(x);
  if (motion_.size() == 0) return slope;
  VectorXd forces(x.size()), bed = VectorXd::Zero(x.size());
  gradient(x, forces);
  bed_.gradient(x, bed);
  for (std::size_t n = 0; n < fixed_.size(); ++n) {
    const auto k = 3 * static_cast<Eigen::Index>(n);
    if (fixed_[n]) slope.supports += forces.segment<3>(k).dot(motion_.segment<3>(k));
  }
  slope.supports -= bed.dot(motion_);
  return slope;
}

double BodyEnergy::value(const VectorXd& x) const {
  return elastic_.value(x) - rest_energy_ + membrane_.value(x) + bed_.value(x) + share_ * weight_.value(x) +
         share_ * pressure_.value(x);
}

double BodyEnergy::gradient(const VectorXd& x, VectorXd& gradient) const {
  gradient.setZero();
  double energy = elastic_.gradient(x, gradient) - rest_energy_;
  energy += membrane_.gradient(x, gradient);
  energy += bed_.gradient(x, gradient);
  energy += share_ * weight_.gradient(x, share_, gradient);
  energy += share_ * pressure_.gradient(x, share_, gradient);
  return energy;
}

void BodyEnergy::hessian(const VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& matrix) const {
  elastic_.hessian(x, kind, matrix);
  membrane_.hessian(x, kind, matrix);
  bed_.hessian(matrix);
  pressure_.hessian(x, kind, share_, matrix);
}

double BodyEnergy::load(const VectorXd& x) const {
  VectorXd nodal = VectorXd::Zero(x.size());
  elastic_.gradient(x, nodal);
  membrane_.gradient(x, nodal);
  return nodal.norm();
}

}  // namespace palpate::solve
