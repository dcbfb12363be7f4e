// SPDX-License-Identifier: GPL-3.0-or-later
// One function a law; the conditions of each are small strain and elements that resolve its contact.
#include "precompute/verify/closed_forms.hpp"

#include "precompute/geometry/solids.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/solve/push/coulomb_push.hpp"
#include "precompute/verify/bonded_layer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::verify {
// A namespace of its own: the numbers of its bodies have names that other checks use as well.
namespace laws {
namespace {

using Shape = ToolScene::Shape;
using std::numbers::pi;

constexpr double kYoung = 5e3, kPoisson = 0.49;
constexpr double kPlane = kYoung / (1 - kPoisson * kPoisson), kShear = kYoung / (2 * (1 + kPoisson));
constexpr double kRadius = 0.01;  // m, of spheres

ToolScene sphere(double radius = kRadius) {
  ToolScene tool;
  tool.radius = radius;
  return tool;
}

solve::PairPath pushes(double depth, std::vector<double> shares) {
  solve::PairPath path;
  path.normal_depths = std::move(shares);
  for (double& share : path.normal_depths) share *= depth;
  return path;
}

struct Elements {
  double contact = 0.0;  // contact radii
  double rim = 0.0;      // the same; 0: no ring
};

// At the middle of the top of a box, held at its bottom.
PairResult press(double half_width, double height, double poisson, const ToolScene& tool_scene,
                 const solve::PairPath& path, const Elements& elements) {
  Scene scene;
  scene.material.young = kYoung;
  scene.material.poisson = poisson;
  SupportScene bottom;
  bottom.point = {0, 0, -height * (1 - 1e-6)};
  scene.supports = {bottom};
  scene.solver.mesh_size = elements.contact;
  scene.solver.rim_size = elements.rim;
  scene.solver.max_size = std::min(height, half_width / 6);  // what is usual for organs would add a per cent
  const Body body = prepare_body(
      scene, geometry::box_solid({-half_width, -half_width, -height}, {half_width, half_width, 0}, height, "box"));
  const tool::Tool tool = tool::make_tool(tool_scene);
  solve::PairOptions options = solve::pair_options(scene);
  solve::without_limits(options);
  return solve::solve_pair({body, tool, tool.vertices[0], ContactFrame{}}, path, options);
}

PairResult press_block(double half, const ToolScene& tool, const solve::PairPath& path, const Elements& elements) {
  return press(half, half, kPoisson, tool, path, elements);
}

// `value(sample, values)` adds what a sample of an accepted pair says.
template <class Value>
LawValues over(const PairResult& r, const Value& value) {
  LawValues v;
  if (!r.outcome.accepted || !r.outcome.cause.empty()) {
    v.cause = r.outcome.cause;
    return v;
  }
  for (const Sample& s : r.samples) value(s, v);
  if (v.values.empty() && v.cause.empty()) v.cause = "no sample of it";
  return v;
}

LawValues hertz(double size, double coarser) {
  const double depth = 0.01 * kRadius, a = std::sqrt(kRadius * depth);
  return over(press_block(size * a, sphere(), pushes(depth, {0.5, 1}), {0.15 * coarser}),
              [&](const Sample& s, LawValues& v) {
                const double d = s.deflection.z();
                if (d < 0.9 * depth) return;
                v.values.push_back({s.force.z() / (4.0 / 3 * kPlane * std::sqrt(kRadius) * std::pow(d, 1.5)), 0.02});
                // Points of coarse elements miss more of the rim: 2.4 % of the radius at 0.25, here 1.2 %, 0.2 % at
                // 0.1.
                const double radius = std::sqrt(s.contact_area / (pi * kRadius * d));
                if (!(std::abs(radius - 1) < 0.02)) v.cause = "the contact's radius is not sqrt(R d)";
                if (s.force.head<2>().norm() > 0.01 * s.force.z())
                  v.cause = "a normal indentation has a tangential force";
              });
}

LawValues flat_punch(double size, double coarser) {
  ToolScene punch;
  punch.shape = Shape::punch;
  punch.radius = 0.005;
  punch.edge_radius = 0.01 * punch.radius;
  const double depth = 0.01 * punch.radius;
  return over(press_block(size * punch.radius, punch, pushes(depth, {0.5, 1}), {0.35 * coarser}),
              [&](const Sample& s, LawValues& v) {
                v.values.push_back({s.force.z() / (2 * kPlane * punch.radius * s.deflection.z()), 0.02});
              });
}

// Its rounded tip is small beside the contact.
LawValues blunt_cone(double size, double coarser) {
  ToolScene cone;
  cone.shape = Shape::cone;
  cone.half_angle = 80 * pi / 180;
  cone.radius = 2e-5;
  const double depth = 0.0004, slope = std::tan(cone.half_angle), a = 2 / pi * slope * depth;
  // Elements of 0.25 a scatter by 2 % between meshes, of 0.15 a by 1 %.
  return over(press_block(size * a, cone, pushes(depth, {0.25, 0.5, 0.75, 1}), {0.1 * coarser}),
              [&](const Sample& s, LawValues& v) {
                const double d = s.deflection.z();
                if (d > 0.7 * depth) v.values.push_back({s.force.z() / (2 / pi * kPlane * slope * d * d), 0.02});
              });
}

// A sphere of ten thicknesses, pressed a tenth of one deep. From the series linear elasticity strays as the contact
// grows.
LawValues layer(double size, double coarser) {
  constexpr double kThickness = 0.001, kDepth = 0.1 * kThickness, kSphere = 10 * kThickness;
  return over(press(size * kThickness, kThickness, 0.4999, sphere(kSphere), pushes(kDepth, {0.1, 0.25, 0.5, 1}),
                    {0.25 * coarser}),
              [&](const Sample& s, LawValues& v) {
                const double d = s.deflection.z(), x = std::sqrt(kSphere * d) / kThickness;
                const double over_hertz = s.force.z() / (16.0 / 9 * kYoung * std::sqrt(kSphere) * std::pow(d, 1.5));
                v.values.push_back({over_hertz / bonded_layer_exact(x), 0.05});
                if (x < 0.35) v.values.push_back({over_hertz / bonded_layer_series(x), 0.05});
              });
}

// The law is linear: at a depth of a thousandth of the radius the pressure stiffens the surface by less than 1 %. Its
// traction is singular at the rim, which takes a ring of small elements.
LawValues mindlin(double size, double coarser) {
  constexpr int kDirections = 4;
  const double depth = 0.001 * kRadius, a = std::sqrt(kRadius * depth);
  solve::PairPath path = pushes(depth, {0.25, 0.5, 0.75, 1});
  path.tangential_depths = {depth};
  path.tangential_directions = kDirections;
  path.tangential_points = 1;
  path.tangential_reach = 0.1;
  path.friction = 1.0;
  path.form_frictionless = true;
  LawValue mean{0, 0.02};  // meshes differ by 1 % from direction to direction
  return over(press_block(size * a, sphere(), path, {0.2 * coarser, 0.035 * coarser}),
              [&](const Sample& s, LawValues& values) {
                if (s.kind != SampleKind::tangential) return;
                const Eigen::Vector2d side = s.deflection.head<2>();
                const double stiffness = -s.force.head<2>().dot(side) / side.squaredNorm();
                mean.over_law += stiffness / (8 * kShear * a / (2 - kPoisson)) / kDirections;
                values.values = {mean};
              });
}

// Formed without friction and then pushed tangentially: at nu 0.49 pressures hardly change. Slip removes the singular
// traction at the rim, so no ring of fine elements is needed.
LawValues partial_slip(double size, double coarser) {
  const double depth = 0.001 * kRadius, a = std::sqrt(kRadius * depth), mu = 0.3;
  solve::PairPath path = pushes(depth, {0.25, 0.5, 0.75, 1});
  path.tangential_depths = {depth};
  path.tangential_directions = 2;
  path.tangential_points = 0;
  path.friction = mu;
  path.form_frictionless = true;
  path.slip_points = 4;
  path.slip_reach = 1.2 * solve::gross_slip_reach(mu, kPoisson);
  double load = 0;
  return over(press_block(size * a, sphere(), path, {0.12 * coarser}), [&](const Sample& s, LawValues& v) {
    if (s.kind == SampleKind::normal) load = s.force.z();
    if (s.kind != SampleKind::slipping) return;
    const double limit = mu * s.force.z(), furthest = 3 * limit * (2 - kPoisson) / (16 * kShear * a);
    const double share = s.deflection.head<2>().norm() / furthest;
    const bool slides = share >= 1;
    const double law = slides ? 1.0 : 1 - std::pow(1 - share, 1.5);
    v.values.push_back({s.force.head<2>().norm() / limit / law, slides ? 0.02 : 0.05});
    v.values.push_back({s.force.z() / load, 0.01});
    if ((s.friction_limit > 0) != slides)
      v.cause = "the friction limit does not distinguish full slip from partial slip";
  });
}

}  // namespace
}  // namespace laws

namespace {

double in_tolerances(const LawValue& v) { return std::abs(v.over_law - 1) / v.tolerance; }

}  // namespace

std::vector<ClosedForm> closed_forms() {
  return {
      {"Hertz", "sphere, d = 0.01 R: F = 4/3 E* sqrt(R) d^1.5, a = sqrt(R d)", 30, 60, laws::hertz},
      {"Sneddon, punch", "edge radius 0.01 of its own: F = 2 E* a d", 40, 80, laws::flat_punch},
      {"Sneddon, cone", "half angle 80 degrees: F = 2/pi E* tan(theta) d^2", 30, 60, laws::blunt_cone},
      {"Dimitriadis", "sphere on a bonded layer, nu 0.4999: the series below sqrt(R d)/h = 0.35, exact to 1", 6, 8,
       laws::layer},
      {"Mindlin", "stuck sphere, d = 0.001 R, tangential push: k = 8 G a / (2 - nu)", 40, 80, laws::mindlin},
      {"Cattaneo and Mindlin", "partial slip: Q = mu P (1 - (1 - s/s_max)^1.5); full slip: Q = mu P", 30, 60,
       laws::partial_slip},
  };
}

bool LawCheck::holds() const {
  if (!cause.empty() || large.empty()) return false;
  for (std::size_t k = 0; k < large.size(); ++k) {
    const double apart = std::abs(small[k].over_law - large[k].over_law);
    if (!(in_tolerances(large[k]) <= 1 && in_tolerances(endless[k]) <= 1 && apart <= large[k].tolerance)) return false;
  }
  return true;
}

LawValue LawCheck::worst() const {
  LawValue worst{1, 1};
  for (const auto* values : {&large, &endless}) {
    for (const LawValue& v : *values) {
      if (in_tolerances(v) > in_tolerances(worst)) worst = v;
    }
  }
  return worst;
}

LawCheck check(const ClosedForm& form) {
  const LawValues small = form.solve(form.small, 1), large = form.solve(form.large, 1);
  LawCheck result{small.cause.empty() ? large.cause : small.cause, small.values, large.values, {}};
  if (result.cause.empty() && small.values.size() != large.values.size()) {
    result.cause = "the two bodies were not resolved at the same depths";
  }
  if (!result.cause.empty()) return result;
  for (std::size_t k = 0; k < large.values.size(); ++k) {
    const double at_large = large.values[k].over_law, at_small = small.values[k].over_law;
    result.endless.push_back(
        {(form.large * at_large - form.small * at_small) / (form.large - form.small), large.values[k].tolerance});
  }
  return result;
}

}  // namespace palpate::verify
