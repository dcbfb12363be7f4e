// SPDX-License-Identifier: GPL-3.0-or-later
// Coulomb friction of a tool at the integration points of the contact: a convex pseudo-potential of the slip for
// normal pressures that are held meanwhile, and the return map that moves the anchors of points that slipped.
#pragma once

#include "precompute/solve/contact/contact.hpp"
#include "precompute/solve/contact/energy_term.hpp"

#include <vector>

namespace palpate::solve {

/// Results of friction at a state of the body.
struct FrictionReport {
  Eigen::Vector3d force{0, 0, 0};  ///< N on the tool, body frame
  double stored = 0.0;             ///< J in the elastic part of the slip
  double traction = 0.0;           ///< N, sum of the lengths of the points' tractions
  double pressure = 0.0;           ///< N, sum of the points' pressures
  double limit = 0.0;              ///< N, sum of the points' limits
  double slipping = 0.0;           ///< share of that sum at points that slip, [0, 1]
  /// The contact slips as a whole: a few points may stick for a moment as they cross the edges of elements.
  [[nodiscard]] bool gross() const { return slipping > 0.98; }
};

/// The tangential traction of a point follows its slip s from its anchor by t = k s up to the limit mu p (Coulomb's law
/// with an elastic slip, e.g. Wriggers 2006, section 5.2). While the pressure p of every point is held, the law has the
/// potential k s^2 / 2 within the limit, L s - L^2 / (2 k) beyond (Huber's function, per area). One step of the tool:
///
///     begin(x);                       the equilibrium that the step starts from
///     minimise, hold(x), minimise ... until the mismatch(x) is small
///     settle(x);                      anchors of points that slipped move, points that left are forgotten
///
/// Points that come into contact during the step take their anchor halfway on their way in the tool's frame. Slip is
/// measured in the plane of the tool's surface under the point when last held.
class FrictionEnergy final : public EnergyTerm {
public:
  /// Coefficient mu >= 0, stiffness k > 0 (Pa/m). `contact` is the tool's, and must outlive this.
  FrictionEnergy(const ContactEnergy& contact, double coefficient, double stiffness)
      : contact_(contact), coefficient_(coefficient), stiffness_(stiffness) {}

  /// A point in contact between steps.
  struct Anchor {
    std::size_t index = 0;              ///< of the contact's points
    Eigen::Vector3d position{0, 0, 0};  ///< m, in the tool's frame
    double limit = 0.0;                 ///< N
  };
  /// By index.
  [[nodiscard]] const std::vector<Anchor>& anchors() const { return anchors_; }
  void set_anchors(std::vector<Anchor> anchors);

  /// Starts a step at the equilibrium x with the tool where it stands: limits from the pressures there; points without
  /// an anchor are anchored where they are.
  void begin(const Eigen::VectorXd& x);
  /// How far the limits are from mu p at x, over the sum of mu p: the sum of the points' differences without their
  /// signs, in which the pressures' own noise shows, and with them.
  struct Mismatch {
    double points = 0.0, sum = 0.0;
  };
  [[nodiscard]] Mismatch mismatch(const Eigen::VectorXd& x) const;
  /// Takes limits and tangent planes from x; `share` of the change of the limits, (0, 1].
  void hold(const Eigen::VectorXd& x, double share = 1.0);
  /// Ends the step at x. Returns the energy (J) dissipated in it, >= 0.
  double settle(const Eigen::VectorXd& x);

  [[nodiscard]] FrictionReport report(const Eigen::VectorXd& x) const;
  /// Moment (N m, body frame) on the tool about `about` (body frame) of tractions and pressures.
  [[nodiscard]] Eigen::Vector3d moment(const Eigen::VectorXd& x, const Eigen::Vector3d& about) const;

  [[nodiscard]] double value(const Eigen::VectorXd& x) const override;
  double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const override;
  void hessian(const Eigen::VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& matrix) const override;

private:
  struct Point {
    std::size_t index;
    std::array<std::int32_t, 6> nodes;
    std::array<double, 6> shape;
    Eigen::Vector3d anchor;  // tool frame
    Eigen::Vector3d normal;  // of the tool's surface, tool frame
    double stiffness;        // N/m
    double limit, before;    // N; before the step: that of its start
  };
  [[nodiscard]] Eigen::Vector3d slip(const Point& point, const Eigen::VectorXd& x) const;
  [[nodiscard]] const Anchor* anchor(std::size_t index) const;
  [[nodiscard]] Eigen::Vector3d landing(const ContactPoint& point) const;
  [[nodiscard]] double lost_by(const Point& point, const Eigen::VectorXd& x) const;
  [[nodiscard]] double limit(const ContactPoint& point) const;

  const ContactEnergy& contact_;
  double coefficient_, stiffness_;
  std::vector<Anchor> anchors_;  // at the start of the step
  std::vector<Point> begun_;     // in contact then
  std::vector<Point> points_;    // that may carry traction now
  Eigen::VectorXd start_;
  Eigen::Isometry3d start_pose_ = Eigen::Isometry3d::Identity();
};

}  // namespace palpate::solve
