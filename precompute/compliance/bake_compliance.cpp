// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/compliance/bake_compliance.hpp"

#include "formats/io/error.hpp"
#include "palpate/format/half_space.hpp"
#include "precompute/compliance/rest_modes.hpp"
#include "precompute/compliance/spread_out.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

namespace palpate::compliance {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr std::size_t kFirstColumns = 48;  // sites: 144 solves
constexpr std::size_t kLeftOut = 21;       // sites: 63 columns
constexpr std::size_t kAtOnce = 8;         // sites: 24 right-hand sides of one solve
constexpr std::size_t kMoreColumns = 48;   // sites that join where the tolerance is not met
constexpr double kWorthwhile = 0.9;        // of the error of the most modes: what they must leave at most to go on
constexpr double kMinSiteShare = 0.5;      // of the site spacing: an element's edge
/// Rounding of the half-space over the smallest tool's contact radius: the force of two contacts one radius apart
/// changes by 0.5 % of it.
constexpr double kRounding = 0.25;
/// Mean square of the distance to the centre under Hertz's traction, over the square of the radius.
constexpr double kHertzSpread = 0.4;
constexpr int kRing = 8;  // points of a ring that stands for the discs of load and reading

/// Half-space between two sites as their discs of radius `disc` feel it: the mean over a ring whose square radius is
/// the sum of both discs' mean squares, which is the mean over both discs to the second order of radius over distance.
Matrix3d half_space_between(const LoadSite& from, const LoadSite& to, double shear, double poisson, double rounding,
                            double disc) {
  const auto point = [&](const Vector3d& p, const Vector3d& n) {
    return half_space::Point{{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, shear};
  };
  const Vector3d u = from.normal.unitOrthogonal(), v = from.normal.cross(u);
  const double radius = disc * std::sqrt(2 * kHertzSpread);
  const half_space::Point reading = point(to.point, to.normal);
  Matrix3d mean = Matrix3d::Zero();
  for (int k = 0; k < kRing; ++k) {
    const double angle = 2 * M_PI * (k + 0.5) / kRing;
    double c[9];
    half_space::compliance(point(from.point + radius * (std::cos(angle) * u + std::sin(angle) * v), from.normal),
                           reading, poisson, rounding, c);
    mean += Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(c) / kRing;
  }
  return mean;
}

std::vector<std::vector<std::size_t>> neighbours_of(const ComplianceSites& sites) {
  std::vector<std::set<std::size_t>> found(sites.places.size());
  for (const auto& t : sites.triangles) {
    for (int k = 0; k < 3; ++k) {
      found[static_cast<std::size_t>(t[k])].insert(static_cast<std::size_t>(t[(k + 1) % 3]));
      found[static_cast<std::size_t>(t[k])].insert(static_cast<std::size_t>(t[(k + 2) % 3]));
    }
  }
  std::vector<std::vector<std::size_t>> result;
  for (const auto& set : found) result.emplace_back(set.begin(), set.end());
  return result;
}

double median_edge(const ComplianceSites& sites) {
  std::vector<double> edges;
  for (const auto& t : sites.triangles) {
    for (int k = 0; k < 3; ++k) {
      edges.push_back((sites.places[static_cast<std::size_t>(t[k])].point -
                       sites.places[static_cast<std::size_t>(t[(k + 1) % 3])].point)
                          .norm());
    }
  }
  std::nth_element(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2), edges.end());
  return edges[edges.size() / 2];
}

/// Columns of the compliance less the half-space.
class Rest {
public:
  Rest(const LinearBody& linear, const ComplianceSites& sites, double shear, double poisson, double rounding)
      : linear_(linear),
        sites_(sites),
        neighbours_(neighbours_of(sites)),
        shear_(shear),
        poisson_(poisson),
        rounding_(rounding) {}

  /// Solves and appends the columns of sites. A site's own block is the mean of its neighbours': that is smooth, and
  /// not used of one contact.
  void add(const std::vector<std::size_t>& sites) {
    const MatrixXd columns = linear_.columns(sites);
    for (std::size_t k = 0; k < sites.size(); ++k) add(sites[k], columns.middleCols<3>(static_cast<Index>(3 * k)));
  }

  [[nodiscard]] Index columns() const { return values_.cols(); }
  [[nodiscard]] double self() const {
    std::vector<double> all = self_;
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
    return all[all.size() / 2];
  }

  /// Modes from all columns but the last `left_out`.
  [[nodiscard]] SignedModes modes(Index count, Index left_out) const {
    const std::vector<Index> known(known_.begin(), known_.end() - left_out);
    return rest_modes(values_.leftCols(values_.cols() - left_out), known, count);
  }

  /// Error of modes on the last `left_out` columns, the sites' own blocks excepted.
  [[nodiscard]] ComplianceError error(const SignedModes& modes, Index left_out, double self) const {
    const std::vector<Index> last(known_.end() - left_out, known_.end());
    const MatrixXd difference = modes.columns(last) - values_.rightCols(left_out);
    std::vector<double> errors;
    for (Index c = 0; c < left_out; c += 3) {
      for (std::size_t s = 0; s < sites_.places.size(); ++s) {
        if (!sites_.touchable[s] || static_cast<Index>(3 * s) == last[static_cast<std::size_t>(c)]) continue;
        const Matrix3d block = difference.block<3, 3>(static_cast<Index>(3 * s), c);
        errors.push_back(block.jacobiSvd().singularValues()[0] / self);
      }
    }
    if (errors.empty()) return {};
    std::sort(errors.begin(), errors.end());
    const auto at = [&](double share) { return errors[static_cast<std::size_t>(share * double(errors.size() - 1))]; };
    return {static_cast<int>(modes.vectors.cols()), at(0.5), at(0.95), errors.back()};
  }

private:
  void add(std::size_t site, const Eigen::MatrixX3d& column) {
    const auto size = static_cast<Index>(3 * sites_.places.size());
    self_.push_back(column.block<3, 3>(static_cast<Index>(3 * site), 0).norm() / std::sqrt(3.0));
    Eigen::MatrixX3d rest(size, 3);
    for (std::size_t s = 0; s < sites_.places.size(); ++s) {
      if (s == site) continue;
      const auto row = static_cast<Index>(3 * s);
      rest.block<3, 3>(row, 0) =
          column.block<3, 3>(row, 0) -
          half_space_between(sites_.places[site], sites_.places[s], shear_, poisson_, rounding_, linear_.load_radius());
    }
    Matrix3d own = Matrix3d::Zero();
    for (const std::size_t n : neighbours_[site]) own += rest.block<3, 3>(static_cast<Index>(3 * n), 0);
    rest.block<3, 3>(static_cast<Index>(3 * site), 0) = own / std::max<double>(1, double(neighbours_[site].size()));
    values_.conservativeResize(size, values_.cols() + 3);
    values_.rightCols<3>() = rest;
    for (int k = 0; k < 3; ++k) known_.push_back(static_cast<Index>(3 * site) + k);
  }

  const LinearBody& linear_;
  const ComplianceSites& sites_;
  std::vector<std::vector<std::size_t>> neighbours_;
  double shear_, poisson_, rounding_;
  MatrixXd values_;
  std::vector<Index> known_;
  std::vector<double> self_;
};

constexpr int kSteps[] = {0, 8, 16, 24, 32, 48, 64, 96, 128};

}  // namespace

void ComplianceOptions::validate() const {
  const auto refuse = [](const std::string& what, double value, const std::string& allowed) {
    throw Error(ExitCode::usage, "compliance: " + what + " is " + std::to_string(value) + ", allowed " + allowed);
  };
  if (!(contact_radius > 0)) refuse("the contact radius", contact_radius, "above 0 m");
  if (!(tolerance > 0 && tolerance < 1)) refuse("the tolerance", tolerance, "above 0 and below 1");
  if (modes < 0 || modes > static_cast<int>(layout::kMaxModes) || modes % static_cast<int>(layout::kModeStep) != 0) {
    refuse("the number of modes", modes, "a multiple of 8 up to 128");
  }
}

BakedCompliance bake_compliance(const Body& body, const ComplianceSites& sites, const ComplianceOptions& options) {
  options.validate();
  const std::vector<std::size_t> order = spread_out(sites.places, sites.touchable);
  if (order.empty()) throw Error(ExitCode::bad_input, "compliance: no site can be touched");
  // Sites of automatic sampling lie closer than the loads need elements.
  const double edge = std::max(kMinSiteShare * median_edge(sites), options.contact_radius / LinearBody::kLoadEdges);
  const LinearBody linear(body, sites.places, {edge, options.contact_radius, options.solver});
  BakedCompliance baked;
  ResponseCompliance& file = baked.file;
  ComplianceReport& report = baked.report;
  file.poisson = body.material.poisson;
  file.rounding = kRounding * options.contact_radius;
  file.shear.assign(sites.places.size(), body.material.young / (2 * (1 + body.material.poisson)));

  // Columns from `used` on are left out; a body of few sites is solved as a whole, and measures itself.
  Rest rest(linear, sites, file.shear[0], file.poisson, file.rounding);
  std::size_t used = std::min(kFirstColumns, order.size());
  const auto solve_to = [&](std::size_t count) {
    for (auto k = static_cast<std::size_t>(rest.columns() / 3); k < count; k += kAtOnce) {
      rest.add({order.begin() + static_cast<std::ptrdiff_t>(k),
                order.begin() + static_cast<std::ptrdiff_t>(std::min(k + kAtOnce, count))});
    }
  };
  SignedModes chosen;
  for (double last = std::numeric_limits<double>::infinity();;) {
    const std::size_t solved = std::min(used + kLeftOut, order.size());
    solve_to(solved);
    const bool all = solved == used;
    const auto measured = static_cast<Index>(3 * (all ? std::min(kLeftOut, used) : solved - used));
    report.errors.clear();
    report.reached = false;
    report.self = rest.self();
    report.columns = solved;
    report.left_out = all ? 0 : solved - used;
    for (const int count : kSteps) {
      // A column carries no more modes than it has values; one half more columns than modes keeps the fit of M stable.
      const bool determined = static_cast<std::size_t>(count) <= 2 * used || count == 0;
      if (!determined) break;
      const SignedModes modes = rest.modes(count, all ? 0 : measured);
      const ComplianceError error = rest.error(modes, measured, report.self);
      report.errors.push_back(error);
      const bool wanted = options.modes > 0 ? count <= options.modes : !report.reached;
      if (wanted) {
        chosen = modes;
        report.chosen = error;
      }
      report.reached = report.reached || error.p95 <= options.tolerance;
    }
    const bool enough = options.modes > 0 ? report.chosen.modes >= options.modes : report.reached;
    const double least = report.errors.back().p95;
    const bool helps = options.modes > 0 || least <= kWorthwhile * last;
    if (enough || all || !helps) break;
    last = least;
    used = std::min(used + kMoreColumns, order.size());
  }
  // The file holds a multiple of kModeStep: vanishing modes fill up, before the negative ones.
  const Index count = chosen.vectors.cols(), positive = count - chosen.negative;
  file.modes = (static_cast<std::uint32_t>(count) + layout::kModeStep - 1) / layout::kModeStep * layout::kModeStep;
  file.negative = static_cast<std::uint32_t>(chosen.negative);
  file.values.assign(std::size_t{3} * file.modes * sites.places.size(), 0.0);
  for (std::size_t s = 0; s < sites.places.size(); ++s) {
    for (Index m = 0; m < count; ++m) {
      const auto to = static_cast<std::size_t>(m < positive ? m : m + static_cast<Index>(file.modes) - count);
      for (int k = 0; k < 3; ++k) {
        file.values[3 * (file.modes * s + to) + static_cast<std::size_t>(k)] =
            chosen.vectors(static_cast<Index>(3 * s) + k, m);
      }
    }
  }
  report.nodes = linear.nodes();
  report.load_radius = linear.load_radius();
  return baked;
}

}  // namespace palpate::compliance
