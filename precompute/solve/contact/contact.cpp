// SPDX-License-Identifier: GPL-3.0-or-later
// Integration of the contact energy over quadratic faces.
#include "precompute/solve/contact/contact.hpp"

#include "precompute/fem/face_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate::solve {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Weights = std::array<std::array<double, 6>, ContactEnergy::kPoints>;

// Centroids of the 16 equal sub-triangles: positive equal weights see a partial contact evenly.
Weights make_weights() {
  Weights all{};
  int q = 0;
  const auto add = [&](double a, double b) { all[q++] = fem::face_values(a, b); };
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; i + j < 4; ++j) {
      add((i + 1.0 / 3) / 4, (j + 1.0 / 3) / 4);
      if (i + j < 3) add((i + 2.0 / 3) / 4, (j + 2.0 / 3) / 4);
    }
  }
  return all;
}

const Weights kShape = make_weights();

}  // namespace

ContactEnergy::ContactEnergy(const mesh::TetMesh& mesh, const std::vector<char>& fixed, const tool::ToolShape& shape,
                             const Eigen::Isometry3d& pose, std::vector<Vector3d> offsets)
    : offsets_(std::move(offsets)),
      shape_(shape),
      middle_(shape.bounds().center()),
      around_(0.5 * shape.bounds().diagonal().norm()),
      pose_(pose) {
  for (const auto& nodes : mesh.faces) {
    if (std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t n) { return fixed[n] != 0; })) {
      held_.push_back(nodes);
      continue;
    }
    const Vector3d a = mesh.nodes[nodes[0]], b = mesh.nodes[nodes[1]], c = mesh.nodes[nodes[2]];
    faces_.push_back({nodes, 0.5 * (b - a).cross(c - a).norm() / kPoints});
  }
  anchors_.held.assign(faces_.size() * kPoints, Hold::none);
  anchors_.position.assign(faces_.size() * kPoints, Vector3d::Zero());
  anchors_.normal = anchors_.position;
}

// Calls visit(face, point index, shape values, position in the tool frame) for the points that may touch
// the tool or hold an anchor.
template <class Visit>
void ContactEnergy::for_each_near(const VectorXd& x, Visit&& visit) const {
  const Matrix3d to_tool = pose_.linear().transpose();
  const Vector3d middle = pose_ * middle_;
  // Gaps up to which there is an answer.
  const double margin = std::max(law_.thickness, multiplier_ / law_.penalty);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Face& face = faces_[f];
    Eigen::Matrix<double, 3, 6> p;
    for (int n = 0; n < 6; ++n) p.col(n) = on_surface(x, face.nodes[n]);
    const Vector3d centre = p.leftCols<3>().rowwise().mean();
    const double reach = 1.3 * std::sqrt((p.colwise() - centre).colwise().squaredNorm().maxCoeff()) + margin;
    const Hold* held = anchors_.held.data() + f * kPoints;
    const bool anchored = std::any_of(held, held + kPoints, [](Hold h) { return h != Hold::none; });
    if (!anchored && ((centre - middle).squaredNorm() > (around_ + reach) * (around_ + reach) ||
                      shape_.lower_bound(to_tool * (centre - pose_.translation())) > reach)) {
      continue;
    }
    p = to_tool * (p.colwise() - pose_.translation()).eval();
    for (int q = 0; q < kPoints; ++q) {
      Vector3d at = Vector3d::Zero();
      for (int n = 0; n < 6; ++n) at += kShape[q][n] * p.col(n);
      if (held[q] == Hold::none && shape_.surely_beyond(at, margin)) continue;
      visit(face, f * kPoints + q, kShape[q], at);
    }
  }
}

Vector3d ContactEnergy::slip(std::size_t point, const Vector3d& at) const {
  const Vector3d from = at - anchors_.position[point], &normal = anchors_.normal[point];
  return from - from.dot(normal) * normal;
}

double ContactEnergy::value(const VectorXd& x) const {
  double sum = 0;
  for_each_near(x, [&](const Face& face, std::size_t k, const auto&, const Vector3d& at) {
    sum += face.weight * answer(k, shape_.distance(at).value).energy;
    if (anchored(k)) {
      sum += 0.5 * anchor_stiffness_ * face.weight * slip(k, at).squaredNorm();
    }
  });
  return sum;
}

double ContactEnergy::gradient(const VectorXd& x, VectorXd& gradient) const {
  double sum = 0;
  for_each_near(x, [&](const Face& face, std::size_t k, const auto& shape, const Vector3d& at) {
    const tool::DistanceSample s = shape_.distance(at);
    const ContactAnswer now = answer(k, s.value);
    if (now.pressure <= 0 && !anchored(k)) return;
    sum += face.weight * now.energy;
    Vector3d pull = -face.weight * now.pressure * s.gradient;
    if (anchored(k)) {
      const Vector3d stretched = slip(k, at);
      sum += 0.5 * anchor_stiffness_ * face.weight * stretched.squaredNorm();
      pull += anchor_stiffness_ * face.weight * stretched;
    }
    const Vector3d world = pose_.linear() * pull;
    for (int n = 0; n < 6; ++n) gradient.segment<3>(3 * face.nodes[n]) += shape[n] * world;
  });
  return sum;
}

void ContactEnergy::hessian(const VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& matrix) const {
  const Face* last = nullptr;
  std::array<Matrix3d, 21> blocks;  // of the face, lower triangle by rows
  const auto flush = [&] {
    if (last == nullptr) return;
    for (int a = 0, k = 0; a < 6; ++a) {
      for (int b = 0; b <= a; ++b, ++k) matrix.add(last->nodes[a], last->nodes[b], blocks[k]);
    }
  };
  for_each_near(x, [&](const Face& face, std::size_t k, const auto& shape, const Vector3d& at) {
    const tool::DistanceSample s = shape_.distance(at);
    const ContactAnswer now = answer(k, s.value);
    if (now.pressure <= 0 && !anchored(k)) return;
    Matrix3d h = Matrix3d::Zero();
    if (now.stiffness > 0) {
      h += face.weight * now.stiffness * s.gradient * s.gradient.transpose();
      if (kind == fem::HessianKind::exact) h -= face.weight * now.pressure * s.hessian;
    }
    if (anchored(k)) {
      const Vector3d& normal = anchors_.normal[k];
      h += anchor_stiffness_ * face.weight * (Matrix3d::Identity() - normal * normal.transpose());
    }
    const Matrix3d world = pose_.linear() * h * pose_.linear().transpose();
    if (last != &face) {
      flush();
      last = &face;
      blocks.fill(Matrix3d::Zero());
    }
    for (int a = 0, place = 0; a < 6; ++a) {
      for (int b = 0; b <= a; ++b, ++place) blocks[place] += shape[a] * shape[b] * world;
    }
  });
  flush();
}

ContactReport ContactEnergy::report(const VectorXd& x) const {
  ContactReport r;
  Vector3d moment = Vector3d::Zero(), give = Vector3d::Zero();  // in the tool's frame
  double bonded_area = 0.0;
  for_each_near(x, [&](const Face& face, std::size_t k, const auto&, const Vector3d& at) {
    const tool::DistanceSample s = shape_.distance(at);
    const auto act = [&](const Vector3d& force) {
      r.force += pose_.linear() * force;
      moment += at.cross(force);
    };
    if (const ContactAnswer now = answer(k, s.value); now.pressure > 0 || bonded(k)) {
      r.normal_energy -= 0.5 * face.weight * now.pressure * s.value;
      act(-face.weight * now.pressure * s.gradient);
      r.penetration = std::max(r.penetration, -s.value);
      r.area += face.weight;
      ++r.points;
    }
    if (anchored(k)) {
      const Vector3d stretched = slip(k, at);
      r.tangential_energy += 0.5 * anchor_stiffness_ * face.weight * stretched.squaredNorm();
      act(anchor_stiffness_ * face.weight * stretched);
      if (bonded(k)) {
        r.bond_gap = std::max(r.bond_gap, s.value);
        give += face.weight * (stretched + s.value * s.gradient);
        bonded_area += face.weight;
      }
    }
  });
  r.moment = pose_.linear() * moment;
  if (bonded_area > 0) r.bond_give = pose_.linear() * give / bonded_area;
  const Eigen::Isometry3d to_tool = pose_.inverse();
  for (const auto& nodes : held_) {
    for (const auto& w : kShape) {
      r.held_overlap = std::max(r.held_overlap, -shape_.distance(to_tool * position(nodes, w, x)).value);
    }
  }
  return r;
}

double ContactEnergy::slip_ratio(const VectorXd& x, const Vector3d& direction, const Vector3d& normal) const {
  double along = 0, across = 0;
  for_each_near(x, [&](const Face& face, std::size_t k, const auto&, const Vector3d& at) {
    const tool::DistanceSample s = shape_.distance(at);
    const double pressure = face.weight * answer(k, s.value).pressure;
    if (pressure <= 0) return;
    const Vector3d g = pose_.linear() * s.gradient;
    const double lean = g.dot(direction);
    along += pressure * std::sqrt(std::max(0.0, g.squaredNorm() - lean * lean));
    across -= pressure * g.dot(normal);
  });
  return across > 0 ? along / across : 1.0;
}

void ContactEnergy::set_multipliers(std::vector<double> pressures) {
  multipliers_ = std::move(pressures);
  multiplier_ = multipliers_.empty() ? 0.0 : *std::max_element(multipliers_.begin(), multipliers_.end());
}

void ContactEnergy::augment(const VectorXd& x) {
  std::vector<double> pressures(anchors_.held.size(), 0.0);
  for_each_near(x, [&](const Face&, std::size_t k, const auto&, const Vector3d& at) {
    pressures[k] = answer(k, shape_.distance(at).value).pressure;
  });
  set_multipliers(std::move(pressures));
}

void ContactEnergy::stick(const VectorXd& x) {
  for_each_near(x, [&](const Face&, std::size_t k, const auto&, const Vector3d& at) {
    if (anchored(k)) return;
    const tool::DistanceSample s = shape_.distance(at);
    if (answer(k, s.value).pressure <= 0) return;
    anchors_.held[k] = Hold::stuck;
    anchors_.position[k] = at;
    anchors_.normal[k] = s.normal();
  });
}

bool ContactEnergy::release(const VectorXd& x) {
  bool any = false;
  for_each_near(x, [&](const Face&, std::size_t k, const auto&, const Vector3d& at) {
    if (anchors_.held[k] != Hold::stuck || answer(k, shape_.distance(at).value).pressure > 0) return;
    anchors_.held[k] = Hold::none;
    any = true;
  });
  return any;
}

std::size_t ContactEnergy::stuck() const {
  return std::size_t(std::count(anchors_.held.begin(), anchors_.held.end(), Hold::stuck));
}

void ContactEnergy::bond(const VectorXd& x) {
  stick(x);
  for_each_near(x, [&](const Face&, std::size_t k, const auto&, const Vector3d& at) {
    if (answer(k, shape_.distance(at).value).pressure > 0) anchors_.held[k] = Hold::bonded;
  });
}

std::vector<ContactPoint> ContactEnergy::touching(const VectorXd& x) const {
  std::vector<ContactPoint> points;
  for_each_near(x, [&](const Face& face, std::size_t k, const auto& shape, const Vector3d& at) {
    const tool::DistanceSample s = shape_.distance(at);
    if (s.value < 0) points.push_back({k, face.nodes, shape, face.weight, at, s});
  });
  return points;
}

double ContactEnergy::gap(const VectorXd& x) const {
  double smallest = std::numeric_limits<double>::max();
  const Matrix3d to_tool = pose_.linear().transpose();
  for (const Face& face : faces_) {
    Eigen::Matrix<double, 3, 6> p;
    for (int n = 0; n < 6; ++n) p.col(n) = to_tool * (on_surface(x, face.nodes[n]) - pose_.translation());
    const Vector3d centre = p.leftCols<3>().rowwise().mean();
    const double reach = 1.3 * (p.colwise() - centre).colwise().norm().maxCoeff();
    if (shape_.lower_bound(centre) - reach > smallest) continue;
    for (int n = 0; n < 6; ++n) smallest = std::min(smallest, shape_.distance(p.col(n)).value);
    for (int q = 0; q < kPoints; ++q) {
      Vector3d at = Vector3d::Zero();
      for (int n = 0; n < 6; ++n) at += kShape[q][n] * p.col(n);
      smallest = std::min(smallest, shape_.distance(at).value);
    }
  }
  return smallest;
}

}  // namespace palpate::solve
