// SPDX-License-Identifier: MIT
// The dented surface of a body, for drawing: vertices of a host's mesh moved by the forces of contacts.
#pragma once

#include "palpate/contact/superposition.hpp"
#include "palpate/contact/tick.hpp"
#include "palpate/geometry/closest_point.hpp"
#include "palpate/shared/compliance.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace palpate::runtime {

/// Contacts of one tick, as a drawing thread needs them. Trivially copyable: a TripleBuffer hands it over.
struct Dents {
  static constexpr int kMost = 8;
  struct One {
    BodyPoint at;            ///< c
    Vec3 force;              ///< N on the tool, body's frame
    Vec3 normal{0, 0, 1};    ///< unit, outward
    double depth = 0;        ///< m, of the tool in the undeformed body
    double radius = 0;       ///< m, of the contact area
    Pose pose;               ///< of the tool in the body's frame
    std::uint32_t tool = 0;  ///< index into the file's tools
  };

  int count = 0;
  One contact[kMost];

  /// Adds a contact that touches. `tick` and `pose`: in the body's frame. Returns false where there is no room.
  bool add(const View& view, const Tick& tick, const Pose& pose, std::uint32_t tool) {
    if (!tick.touches()) return true;
    if (count == kMost) return false;
    const double radius = ContactRadius(view, tool).at(tick.depth);
    contact[count++] = {tick.at, tick.force, tick.normal, tick.depth, radius, pose, tool};
    return true;
  }
};

/// Moves the vertices of a mesh by
///
///     u(x) = - sum over k of C(x, c_k) f_k            C  the file's compliance (m/N)       f_k  force on tool k (N)
///
/// and then those inside a sphere or capsule out to its skin. Near c_k the half-space's part of C is that of Hertz'
/// pressure over the contact area, scaled so that c_k lies at the depth of the tool. For a host's thread: bind()
/// allocates. Vertices inside punches and meshes keep u.
class Dent {
public:
  /// `view`: a file with layout::feature_compliance, which must outlive this.
  explicit Dent(const View& view) : view_(&view), compliance_(view), sites_(view.meta->site_count) {}

  /// Takes the vertices (m, body's frame, undeformed), each with its nearest point of the contact surface.
  void bind(const Vec3* rest, std::size_t count) {
    vertices_.clear();
    vertices_.reserve(count);
    BodyPoint near;
    for (std::size_t i = 0; i < count; ++i) {
      near = closest_point(*view_, rest[i], near).at;
      Vertex v;
      v.at = near;
      site_weights(*view_, near, v.weights);
      const Vec3 n = smooth_normal(*view_, near, v.weights);
      v.place = {{rest[i].x, rest[i].y, rest[i].z}, {n.x, n.y, n.z}, 0};
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t site = view_->triangle(near.triangle).site[k];
        v.place.shear += v.weights[k] * static_cast<double>(view_->compliance_site(site).shear);
      }
      vertices_.push_back(v);
    }
  }
  [[nodiscard]] std::size_t count() const { return vertices_.size(); }

  /// Writes the moved vertices (m, body's frame). 3 modes x sites multiply-adds, and about 60 for each vertex and
  /// contact.
  void apply(const Dents& dents, Vec3* moved) {
    CompliancePoint loaded[Dents::kMost];
    for (int k = 0; k < dents.count; ++k) compliance_.locate(dents.contact[k].at, loaded[k]);
    move_sites(dents, loaded);
    double near[Dents::kMost];
    scale_near_parts(dents, loaded, near);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const Vertex& v = vertices_[i];
      Vec3 u = by_modes(v.at, v.weights);
      for (int k = 0; k < dents.count; ++k) u = u - half_space_part(v.place, dents.contact[k], loaded[k], near[k]);
      const double* p = v.place.position;
      moved[i] = Vec3{p[0], p[1], p[2]} + u;
      for (int k = 0; k < dents.count; ++k) push_out(dents.contact[k], moved[i]);
    }
  }

private:
  /// In contact radii, or roundings of the file where these are larger: from 1 on the near part fades, and is gone
  /// here. A rounded half-space and Hertz' displacement then differ by 2 %, and the modes hold this difference.
  static constexpr double kFar = 2.5;

  struct Vertex {
    half_space::Point place;
    BodyPoint at;
    double weights[3];
  };

  /// N, that makes the dent of a contact: less than its force at a depth, where tissue is stiffer (Compliance).
  [[nodiscard]] Vec3 dent_force(const Dents::One& contact) const {
    return (1 / compliance_.stretch(contact.depth)) * contact.force;
  }

  /// The modes' part at the sites.
  void move_sites(const Dents& dents, const CompliancePoint* loaded) {
    const std::uint32_t modes = view_->compliance->modes;
    double share[layout::kMaxModes] = {};  // sqrt(N m), of each mode
    for (std::uint32_t m = 0; m < modes; ++m) {
      for (int k = 0; k < dents.count; ++k) {
        const auto& c = loaded[k].loads;
        share[m] -= dot({c[0][m], c[1][m], c[2][m]}, dent_force(dents.contact[k]));
      }
    }
    for (std::uint32_t s = 0; s < sites_.size(); ++s) {
      const std::int16_t* const values = view_->compliance_modes(s);
      Vec3 u;
      for (std::uint32_t m = 0; m < modes; ++m) {
        u = u + share[m] * Vec3{double(values[3 * m]), double(values[3 * m + 1]), double(values[3 * m + 2])};
      }
      sites_[s] = static_cast<double>(view_->compliance_site(s).unit) * u;
    }
  }

  [[nodiscard]] Vec3 by_modes(const BodyPoint& at, const double (&weights)[3]) const {
    Vec3 u;
    for (int k = 0; k < 3; ++k) u = u + weights[k] * sites_[view_->triangle(at.triangle).site[k]];
    return u;
  }

  /// The scale of each contact's near part with which c lies at the tool's depth, the other near parts unscaled.
  void scale_near_parts(const Dents& dents, const CompliancePoint* loaded, double* near) const {
    constexpr double kLeast = 0.5, kMost = 2;  // of the scale: half to twice the displacement that Hertz gives
    for (int k = 0; k < dents.count; ++k) {
      const Dents::One& contact = dents.contact[k];
      double weights[3];
      site_weights(*view_, contact.at, weights);
      Vec3 u = by_modes(contact.at, weights);
      for (int j = 0; j < dents.count; ++j) {
        if (j != k) u = u - half_space_part(loaded[k].place, dents.contact[j], loaded[j], 1);
      }
      const double own = dot(contact.normal, half_space_part(loaded[k].place, contact, loaded[k], 1));
      near[k] = own > 0 ? clamped((contact.depth + dot(contact.normal, u)) / own, kLeast, kMost) : 1;
    }
  }

  /// m, displacement of `to` against the force on the tool, by the half-space. `near`: scale of its near part.
  [[nodiscard]] Vec3 half_space_part(const half_space::Point& to, const Dents::One& contact,
                                     const CompliancePoint& from, double near) const {
    const double rounding = view_->compliance->rounding;
    double c[9];
    half_space::compliance(from.place, to, view_->compliance->poisson, rounding, c);
    const Vec3 way{to.position[0] - from.place.position[0], to.position[1] - from.place.position[1],
                   to.position[2] - from.place.position[2]};
    const double r = length(way), zone = larger(rounding, contact.radius);
    const double share = clamped((kFar - r / zone) / (kFar - 1), 0, 1);
    double size = 1;
    if (share > 0 && contact.radius > 0) {
      const double hertz = std::sqrt(r * r + rounding * rounding) * mean_inverse_distance(r, contact.radius);
      size += share * (near * hertz - 1);
    }
    const Vec3 f = size * dent_force(contact);
    return {c[0] * f.x + c[1] * f.y + c[2] * f.z, c[3] * f.x + c[4] * f.y + c[5] * f.z,
            c[6] * f.x + c[7] * f.y + c[8] * f.z};
  }

  /// 1/m, mean of 1 / distance from a point at `r` (m) to Hertz' pressure over a disc of `radius` a (m); its
  /// displacement (Johnson 1985, section 3.4) is u(r) / u(0) = 1 - r^2 / (2 a^2) inside, and outside
  /// ((2 - r^2/a^2) asin(a/r) + sqrt(r^2/a^2 - 1)) / pi.
  [[nodiscard]] static double mean_inverse_distance(double r, double radius) {
    constexpr double kPi = kFullTurn / 2;
    const double x = r / radius;
    const double shape = x < 1 ? 1 - 0.5 * x * x : ((2 - x * x) * std::asin(1 / x) + std::sqrt(x * x - 1)) / kPi;
    return 0.75 * kPi / radius * shape;
  }

  /// A point inside the tool goes straight to the skin.
  void push_out(const Dents::One& contact, Vec3& at) const {
    const layout::ToolRecord& tool = view_->tool(contact.tool);
    if (!(tool.probe_radius > 0)) return;
    const Vec3 local = contact.pose.unapply(at);
    const Vec3 core{0, 0, clamped(local.z, 0, tool.axis_length)};
    const Vec3 out = local - core;
    const double distance = length(out);
    if (!(distance < tool.probe_radius)) return;
    at = contact.pose.apply(core + tool.probe_radius * unit(out, {0, 0, -1}));
  }

  const View* view_;
  Compliance compliance_;
  std::vector<Vec3> sites_;  ///< m, displacements by the modes
  std::vector<Vertex> vertices_;
};

}  // namespace palpate::runtime
