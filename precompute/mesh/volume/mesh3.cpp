// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL Mesh_3 over a domain that is labelled by the signs of the distances to the surfaces.
#include "precompute/mesh/volume/mesh3.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/cgal_mesh.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/mesh/surface/feature_polylines.hpp"

#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/make_mesh_3.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;
using Kernel = geometry::CgalKernel;
using Domain = CGAL::Mesh_domain_with_polyline_features_3<CGAL::Labeled_mesh_domain_3<Kernel>>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

// Mesh_3's sizes are radii of circumscribed spheres and balls; these make edges as long as the field says.
constexpr double kEdge = 0.95, kFacet = 0.62, kCell = 0.72, kChord = 0.1;
constexpr double kSliver = 5;  // degrees; perturbation takes its time for every sliver below

// The size field times `scale`; on an inclusion's surface at most `cap` times the inclusion's diagonal.
struct ScaledSize {
  using FT = Kernel::FT;
  using Point_3 = Kernel::Point_3;
  using Index = Domain::Index;
  const SizeField* size;
  const std::vector<double>* diagonals;  // of the inclusions
  const Deadline* deadline;
  double scale, cap;
  FT operator()(const Point_3& p, int dimension, const Index& index) const {
    deadline->check();
    const double h = scale * (*size)(geometry::to_eigen(p));
    if (dimension != 2) return h;
    const auto* patch = boost::get<Domain::Surface_patch_index>(&index);
    const int label = patch == nullptr ? 0 : std::max(patch->first, patch->second);
    return label < 2 ? h : std::min(h, cap * (*diagonals)[static_cast<std::size_t>(label - 2)]);
  }
};

// Which region a point lies in: 0 outside, 1 the body, 2 and on the inclusions. Distances are dear and Mesh_3
// halves segments: a point nearer to an answered one than that was to any surface has the same answer.
class Regions {
public:
  Regions(const Body& body, const Deadline& deadline) : body_(body), deadline_(deadline) {}

  int operator()(const Vector3d& p) {
    deadline_.check();
    for (const Answer& a : recent_) {
      if ((p - a.point).squaredNorm() < a.clear * a.clear) return a.label;
    }
    double d = body_.query->signed_distance(p);
    double clear = std::abs(d);
    int label = d < 0 ? 1 : 0;
    for (std::size_t k = 0; k < body_.inclusions.size() && label == 1; ++k) {
      d = body_.inclusions[k].query->signed_distance(p);
      clear = std::min(clear, std::abs(d));
      if (d < 0) label = static_cast<int>(k) + 2;
    }
    recent_[next_] = {p, clear, label};
    next_ = (next_ + 1) % recent_.size();
    return label;
  }

private:
  struct Answer {
    Vector3d point{0, 0, 0};
    double clear = 0;
    int label = 0;
  };
  const Body& body_;
  const Deadline& deadline_;
  std::array<Answer, 32> recent_;
  std::size_t next_ = 0;
};

// Points of an inclusion's surface that become corners: without a first vertex on it Mesh_3 may never notice a
// small inclusion.
std::vector<Vector3d> first_points(const geometry::SurfaceQuery& query) {
  std::vector<Vector3d> points;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const auto& all = query.surface().vertices;
      points.push_back(*std::max_element(all.begin(), all.end(), [&](const Vector3d& a, const Vector3d& b) {
        return sign * a[axis] < sign * b[axis];
      }));
    }
  }
  return points;
}

void add_features(const Body& body, const std::vector<Vector3d>& anchors, Domain& domain) {
  std::vector<Vector3d> corners = anchors;
  std::vector<std::vector<Kernel::Point_3>> lines;
  const auto add_lines = [&](const geometry::SurfaceQuery& query) {
    for (const auto& line : feature_polylines(query, anchors)) {
      auto& points = lines.emplace_back();
      for (const Vector3d& p : line) points.push_back(geometry::to_cgal(p));
    }
  };
  add_lines(*body.query);
  for (const Inclusion& inclusion : body.inclusions) {
    add_lines(*inclusion.query);
    if (inclusion.query->feature_edges().empty()) {
      for (const Vector3d& p : first_points(*inclusion.query)) corners.push_back(p);
    }
  }
  domain.add_features(lines.begin(), lines.end());
  for (const Vector3d& c : corners) domain.add_corner(geometry::to_cgal(c));
}

LinearTets read_out(const Complex& complex) {
  LinearTets mesh;
  std::map<Complex::Vertex_handle, std::int32_t> number;
  for (const auto v : complex.triangulation().finite_vertex_handles()) {
    number.emplace(v, static_cast<std::int32_t>(mesh.points.size()));
    mesh.points.push_back(geometry::to_eigen(complex.triangulation().point(v).point()));
  }
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
    std::array<std::int32_t, 4> t{};
    for (int k = 0; k < 4; ++k) t[k] = number.at(cell->vertex(k));
    mesh.tets.push_back(t);
    mesh.regions.push_back(complex.subdomain_index(cell) - 1);
  }
  return mesh;
}

}  // namespace

MesherAnswer mesh_by_mesh3(const Body& body, const SizeField& size, const std::vector<Vector3d>& anchors,
                           const Deadline& deadline) {
  // The perturber draws from this thread's generator.
  CGAL::get_default_random() = CGAL::Random(0);
  // Mesh_3 evaluates sizes and labels throughout, so they check the time.
  const auto regions = std::make_shared<Regions>(body, deadline);
  const std::function<int(const Kernel::Point_3&)> label = [regions](const Kernel::Point_3& p) {
    return (*regions)(geometry::to_eigen(p));
  };
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : body.query->surface().vertices) box.extend(v);
  const double radius = 0.6 * box.diagonal().norm();
  const Kernel::Sphere_3 around(geometry::to_cgal(box.center()), radius * radius);
  CGAL::Random random(0);
  Domain domain(label, around, CGAL::parameters::relative_error_bound = 1e-6, CGAL::parameters::p_rng = &random);
  add_features(body, anchors, domain);

  std::vector<double> diagonals;
  for (const Inclusion& inclusion : body.inclusions)
    diagonals.push_back(geometry::diagonal(inclusion.query->surface()));
  const auto scaled = [&](double scale, double cap) { return ScaledSize{&size, &diagonals, &deadline, scale, cap}; };
  const ScaledSize edge = scaled(kEdge, 1), facet = scaled(kFacet, 0.12), cell = scaled(kCell, 1),
                   chord = scaled(kChord, 0.008);
  const Criteria criteria(CGAL::parameters::edge_size = edge, CGAL::parameters::facet_angle = 25,
                          CGAL::parameters::facet_size = facet, CGAL::parameters::facet_distance = chord,
                          CGAL::parameters::cell_radius_edge_ratio = 2, CGAL::parameters::cell_size = cell);
  // No time limits here: they would make the result depend on the machine's load.
  const Complex complex = CGAL::make_mesh_3<Complex>(
      domain, criteria,
      CGAL::parameters::perturb(CGAL::parameters::time_limit = 0, CGAL::parameters::sliver_bound = kSliver),
      CGAL::parameters::exude(CGAL::parameters::time_limit = 0, CGAL::parameters::sliver_bound = kSliver));
  MesherAnswer answer;
  answer.tets = read_out(complex);
  return answer;
}

}  // namespace palpate::mesh
