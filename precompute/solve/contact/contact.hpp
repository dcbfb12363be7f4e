// SPDX-License-Identifier: GPL-3.0-or-later
// Energy of a rigid tool, given as a signed distance function, against the faces of a mesh: normal contact at 16
// points a face (a penalty by default), sticking anchors at the points that have touched, bonds that also carry
// tension.
#pragma once

#include "precompute/solve/contact/contact_law.hpp"
#include "precompute/solve/contact/energy_term.hpp"
#include "precompute/tool/tool.hpp"

#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace palpate::solve {

/// Force, area and other results of the contact at a state of the body.
struct ContactReport {
  Eigen::Vector3d force{0, 0, 0};      ///< N on the tool, body frame
  Eigen::Vector3d moment{0, 0, 0};     ///< N m on the tool about the origin of its frame, body frame
  double normal_energy = 0.0;          ///< J, half of pressure times overlap: stored in the normal penalty
  double tangential_energy = 0.0;      ///< J stored in the anchors
  double penetration = 0.0;            ///< m, largest overlap at an integration point
  double area = 0.0;                   ///< m^2, undeformed
  double held_overlap = 0.0;           ///< m, largest overlap with held surface, which gives no force
  std::uint32_t points = 0;            ///< integration points in contact, or bonded
  double bond_gap = 0.0;               ///< m, largest gap at a bonded point
  Eigen::Vector3d bond_give{0, 0, 0};  ///< m, mean way of bonded points from where they were bonded, body frame
};

/// An integration point of a face, on which friction and bonds act. They use a penalty without multipliers.
struct ContactPoint {
  std::size_t index = 0;  ///< of all the contact's points
  std::array<std::int32_t, 6> nodes{};
  std::array<double, 6> shape{};  ///< values of the face's shape functions
  double weight = 0.0;            ///< m^2, undeformed
  Eigen::Vector3d at{0, 0, 0};    ///< m, in the tool's frame
  tool::DistanceSample distance;  ///< of the tool there
};

class ContactEnergy final : public EnergyTerm {
public:
  /// Faces with all nodes fixed take no part; the report shows when the tool reaches them. `pose` carries the tool
  /// frame into the body's. `offsets` (m, a node; none: all zero) are added to the nodes of faces, see surface_offsets.
  ContactEnergy(const mesh::TetMesh& mesh, const std::vector<char>& fixed, const tool::ToolShape& shape,
                const Eigen::Isometry3d& pose, std::vector<Eigen::Vector3d> offsets = {});

  void set_translation(const Eigen::Vector3d& translation) { pose_.translation() = translation; }
  [[nodiscard]] const Eigen::Vector3d translation() const { return pose_.translation(); }
  void set_rotation(const Eigen::Matrix3d& rotation) { pose_.linear() = rotation; }
  [[nodiscard]] const Eigen::Isometry3d& pose() const { return pose_; }
  [[nodiscard]] const tool::ToolShape& shape() const { return shape_; }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& offsets() const { return offsets_; }
  /// Pressure per overlap (Pa/m) of the normal penalty.
  void set_penalty(double stiffness) { law_.penalty = stiffness; }
  [[nodiscard]] double penalty() const { return law_.penalty; }
  /// A log barrier of this thickness in the penalty's place, see ContactLaw; 0: the penalty again.
  void set_barrier(double thickness, double floor) { law_.thickness = thickness, law_.floor = floor; }
  [[nodiscard]] const ContactLaw& law() const { return law_; }
  /// Per point a pressure (Pa) that an overlap of 0 answers with (augmented Lagrange); empty: none.
  void set_multipliers(std::vector<double> pressures);
  [[nodiscard]] const std::vector<double>& multipliers() const { return multipliers_; }
  /// Takes the pressures at x as multipliers (Uzawa's step).
  void augment(const Eigen::VectorXd& x);
  /// The same for the anchors.
  void set_anchor_stiffness(double stiffness) { anchor_stiffness_ = stiffness; }

  [[nodiscard]] double value(const Eigen::VectorXd& x) const override;
  double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const override;
  void hessian(const Eigen::VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& matrix) const override;
  [[nodiscard]] ContactReport report(const Eigen::VectorXd& x) const;

  /// Tangential force at gross slip towards unit `direction` over the normal force along `normal`, for a
  /// Coulomb coefficient of 1: the sum of pressures times the slope of the tool's surface, seen along it.
  [[nodiscard]] double slip_ratio(const Eigen::VectorXd& x, const Eigen::Vector3d& direction,
                                  const Eigen::Vector3d& normal) const;

  /// Anchors every point in contact that has no anchor; it is unstressed where it stands.
  void stick(const Eigen::VectorXd& x);
  /// Lets go of anchored points that have left the contact, unless they are bonded. True when any did.
  bool release(const Eigen::VectorXd& x);
  [[nodiscard]] std::size_t stuck() const;  ///< points that are anchored and not bonded
  /// Bonds every point in contact, with the anchor that it has or is given where it stands: from then on it answers a
  /// gap as it does an overlap, and is not released. Bonds use a penalty alone, without multipliers or barrier.
  void bond(const Eigen::VectorXd& x);

  /// The place (m, body frame) of the point of a face with these shape values.
  [[nodiscard]] Eigen::Vector3d position(const std::array<std::int32_t, 6>& nodes, const std::array<double, 6>& shape,
                                         const Eigen::VectorXd& x) const {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    for (int n = 0; n < 6; ++n) at += shape[n] * on_surface(x, nodes[n]);
    return at;
  }
  /// The points that overlap the tool, by index.
  [[nodiscard]] std::vector<ContactPoint> touching(const Eigen::VectorXd& x) const;

  /// Smallest signed distance of the surface's integration points and corners to the tool (m).
  [[nodiscard]] double gap(const Eigen::VectorXd& x) const;

  enum class Hold : char { none, stuck, bonded };
  struct Anchors {
    std::vector<Hold> held;
    std::vector<Eigen::Vector3d> position, normal;  // of the tool's surface there, in the tool frame
  };
  [[nodiscard]] const Anchors& anchors() const { return anchors_; }
  void set_anchors(const Anchors& anchors) { anchors_ = anchors; }

  static constexpr int kPoints = 16;

private:
  struct Face {
    std::array<std::int32_t, 6> nodes;
    double weight;  // m^2 of a point
  };
  /// Elongation of an anchor along the tool's surface (m, tool frame); `at` is the position of its point.
  [[nodiscard]] Eigen::Vector3d slip(std::size_t point, const Eigen::Vector3d& at) const;
  /// The place (m) of a node of a face for the contact.
  [[nodiscard]] Eigen::Vector3d on_surface(const Eigen::VectorXd& x, std::int32_t node) const {
    const Eigen::Vector3d at = x.segment<3>(3 * node);
    return offsets_.empty() ? at : Eigen::Vector3d(at + offsets_[static_cast<std::size_t>(node)]);
  }
  template <class Visit>
  void for_each_near(const Eigen::VectorXd& x, Visit&& visit) const;
  [[nodiscard]] bool anchored(std::size_t point) const { return anchors_.held[point] != Hold::none; }
  [[nodiscard]] bool bonded(std::size_t point) const { return anchors_.held[point] == Hold::bonded; }
  [[nodiscard]] ContactAnswer answer(std::size_t point, double gap) const {
    if (bonded(point)) return law_.bonded(gap);
    return law_.answer(gap, multipliers_.empty() ? 0.0 : multipliers_[point]);
  }

  std::vector<Face> faces_;
  std::vector<std::array<std::int32_t, 6>> held_;  // faces that take no part
  std::vector<Eigen::Vector3d> offsets_;           // m, of the nodes
  const tool::ToolShape& shape_;
  Eigen::Vector3d middle_;  // of the tool in its own frame
  double around_;           // m, radius of the ball about it that holds the tool
  Eigen::Isometry3d pose_;
  ContactLaw law_;
  std::vector<double> multipliers_;  // Pa
  double multiplier_ = 0.0;          // Pa, the largest of them
  double anchor_stiffness_ = 0.0;
  Anchors anchors_;
};

}  // namespace palpate::solve
