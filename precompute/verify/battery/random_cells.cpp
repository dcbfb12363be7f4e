// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/battery/random_cells.hpp"

#include "datasets-synthetic/random.hpp"
#include "precompute/geometry/solids.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace palpate::verify {
namespace {

using Eigen::Vector3d;
using synth::Random;
using LawKind = MaterialScene::Law;
using Shape = ToolScene::Shape;

// Triangles of a round body: 20 times its square. The scenes' facets are then 0.4 degrees of a ball's surface wide.
constexpr int kFrequency = 16;
constexpr double kWidestContact =
    0.3;  // contact radius over the thickness: a wider one presses over the edges of a block

// Uniform in the logarithm.
double spread(Random& random, double low, double high) { return low * std::pow(high / low, random.uniform(0.0, 1.0)); }

bool chance(Random& random, double share) { return random.uniform(0, 1) < share; }

template <class T, std::size_t N>
T one_of(Random& random, const T (&choices)[N]) {
  return choices[std::size_t(random.uniform(0, double(N)))];
}

// Its own box, the height of which is the body's thickness.
struct Drawn {
  BatteryCell cell;
  Vector3d low{0, 0, 0}, high{0, 0, 0};
  double thickness = 0.0;  // m
  std::string words;       // of the cell's name
};

void draw_material(Random& random, MaterialScene& m, std::string& words) {
  m.young = spread(random, 100, 1e10);
  m.poisson = chance(random, 0.5) ? one_of(random, {0.0, 0.3, 0.45, 0.49, 0.499}) : random.uniform(0, 0.499);
  const double shear = m.young / (2 * (1 + m.poisson));
  m.law = one_of(random, {LawKind::neo_hookean, LawKind::neo_hookean, LawKind::neo_hookean, LawKind::mooney_rivlin,
                          LawKind::ogden, LawKind::veronda_westmann, LawKind::linear});
  const char* law = "neo-Hookean";
  switch (m.law) {
    case LawKind::mooney_rivlin: {
      const double share = random.uniform(0.3, 1);
      m.c10 = share * shear / 2;
      m.c01 = (1 - share) * shear / 2;
      law = "Mooney-Rivlin";
      break;
    }
    case LawKind::ogden: {
      const double alpha = one_of(random, {2.0, 4.0, 8.0});
      m.terms = {{2 * shear / alpha, alpha}};
      law = "Ogden";
      break;
    }
    case LawKind::veronda_westmann:
      m.poisson = one_of(random, {0.49, 0.499});  // a smaller one has no volume term for such exponents
      m.beta = random.uniform(1, 5);
      m.c2 = 0.0;
      m.c1 = shear / (2 * m.beta);
      law = "Fung";
      break;
    case LawKind::linear:
      m.poisson = std::min(m.poisson, 0.45);
      law = "linear";
      break;
    default:
      break;
  }
  m.young = small_strain_young(m);
  words += fmt::format(", {} {:.3g} Pa nu {:.3g}", law, m.young, m.poisson);
}

// A point of the upper side, not nearer to the sides than a quarter of the width, and the normal there.
void draw_site(Random& random, Drawn& d, bool round) {
  BatteryCell& cell = d.cell;
  if (!round) {
    const Vector3d middle = 0.5 * (d.low + d.high), half = 0.5 * (d.high - d.low);
    cell.site = middle + Vector3d(random.uniform(-0.5, 0.5) * half.x(), random.uniform(-0.5, 0.5) * half.y(), half.z());
    return;
  }
  const double angle = random.uniform(0, 2 * std::numbers::pi), tilt = random.uniform(0, 0.5);
  const Vector3d wanted(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt));
  double best = -1;
  for (const auto& t : cell.surface.triangles) {
    const Vector3d &a = cell.surface.vertices[std::size_t(t[0])], &b = cell.surface.vertices[std::size_t(t[1])],
                   &c = cell.surface.vertices[std::size_t(t[2])];
    const Vector3d normal = (b - a).cross(c - a).normalized();
    if (normal.dot(wanted) <= best) continue;
    best = normal.dot(wanted);
    cell.site = (a + b + c) / 3;
    cell.normal = normal;
  }
}

void draw_body(Random& random, Drawn& d) {
  BatteryCell& cell = d.cell;
  const double size = spread(random, 1e-3, 1);  // m, the thickness
  d.thickness = size;
  const double kind = random.uniform(0, 4);
  const double x = random.uniform(0.5, 1), y = random.uniform(0.5, 1);  // half widths over the thickness
  if (kind < 2) {
    const bool slab = kind >= 1;
    cell.family = slab ? "slab" : "block";
    const double wider = slab ? random.uniform(2, 6) : 1.0;
    d.low = {-x * wider * size, -y * wider * size, 0};
    d.high = {x * wider * size, y * wider * size, size};
    cell.surface = geometry::box_solid(d.low, d.high, size, cell.family);
    draw_site(random, d, false);
    return;
  }
  cell.family = kind < 3 ? "ball" : "ellipsoid";
  const Vector3d axes = 0.5 * size * (kind < 3 ? Vector3d(1, 1, 1) : Vector3d(2 * x, 2 * y, 1));
  cell.surface = geometry::geodesic_sphere(kFrequency, cell.family);
  const Vector3d centre(0, 0, axes.z());
  for (Vector3d& v : cell.surface.vertices) v = centre + axes.cwiseProduct(v);
  d.low = centre - axes;
  d.high = centre + axes;
  draw_site(random, d, true);
}

void draw_support(Random& random, Drawn& d) {
  SupportScene support;
  const double height = d.high.z() - d.low.z();
  const bool round = d.cell.family == "ball" || d.cell.family == "ellipsoid";
  const double way = random.uniform(0, 4);
  const double below = d.low.z() + (round ? random.uniform(0.1, 0.35) * height : 1e-6 * height);
  if (way < 1) {
    support.kind = SupportScene::Kind::box;
    const double share = round ? 2.0 : random.uniform(0.5, 1.1);
    support.box_min = {share * d.low.x(), share * d.low.y(), d.low.z() - height};
    support.box_max = {share * d.high.x(), share * d.high.y(), below};
    d.words += ", held in a box";
  } else if (way < 1.5 && !round) {
    for (const double side : {-1.0, 1.0}) {
      SupportScene plane;
      plane.point = {side * 0.8 * d.high.x(), 0, 0};
      plane.normal = {-side, 0, 0};
      d.cell.scene.supports.push_back(plane);
    }
    d.words += ", held at two sides";
    return;
  } else {
    support.point = {0, 0, below};
    if (way > 3) {
      support.type = SupportScene::Type::spring;
      support.stiffness = d.cell.scene.material.young / height * spread(random, 0.3, 1e3);
      d.words += fmt::format(", on a bed of {:.3g} N/m^3", support.stiffness);
    }
  }
  d.cell.scene.supports.push_back(support);
}

// A ball under the site, a tenth of the thickness clear of every side.
void draw_inclusion(Random& random, Drawn& d) {
  if (!chance(random, 1.0 / 3)) return;
  const double radius = random.uniform(0.08, 0.22) * d.thickness;
  const double cover = random.uniform(0.1, 0.3) * d.thickness;
  RegionScene lump;
  lump.name = "lump";
  lump.shape = RegionScene::Shape::ellipsoid;
  lump.radii = Vector3d::Constant(radius);
  lump.centre = d.cell.site - (cover + radius) * d.cell.normal;
  const double contrast = spread(random, 1e-3, 1e3);
  lump.material.young = std::min(contrast * d.cell.scene.material.young, 1e12);
  lump.material.poisson = one_of(random, {0.3, 0.45, 0.49});
  d.cell.scene.regions.push_back(lump);
  d.words +=
      fmt::format(", ball of {:.3g} mm {:.3g} mm deep {:.3g} times as stiff", 1e3 * radius, 1e3 * cover, contrast);
}

void draw_tool(Random& random, Drawn& d) {
  ToolScene tool;
  tool.shape = one_of(random, {Shape::sphere, Shape::punch, Shape::capsule, Shape::cone});
  const bool cone = tool.shape == Shape::cone, punch = tool.shape == Shape::punch;
  tool.radius = d.thickness * (cone ? spread(random, 1e-4, 0.05) : spread(random, 1e-4, punch ? kWidestContact : 2.0));
  tool.length = std::max(4 * tool.radius, 2 * d.thickness);
  double deepest = tool.radius * spread(random, 0.02, 0.6);
  const char* name = "sphere";
  if (punch) {
    name = "punch";
    tool.edge_radius = random.uniform(0.05, 0.4) * tool.radius;
    deepest = tool.radius * spread(random, 0.02, 0.3);
  } else if (cone) {
    name = "cone";
    tool.half_angle = random.uniform(0.35, 1.4);
    deepest = tool.radius * spread(random, 0.1, 2);
  } else if (tool.shape == Shape::capsule) {
    name = "capsule tip";
    tool.whole = false;
  }
  if (!cone && !punch)
    deepest = std::min(deepest, kWidestContact * kWidestContact * d.thickness * d.thickness / tool.radius);
  d.cell.depth = std::min(deepest, random.uniform(0.05, 0.25) * d.thickness);
  d.cell.scene.tools = {tool};
  d.words += fmt::format(", {} {:.3g} mm, depth {:.3g} mm", name, 1e3 * tool.radius, 1e3 * d.cell.depth);
}

BatteryCell draw(Random& random) {
  Drawn d;
  Scene& scene = d.cell.scene;
  draw_body(random, d);
  d.words = fmt::format("{:.3g} mm", 1e3 * d.thickness);
  draw_material(random, scene.material, d.words);
  draw_support(random, d);
  draw_inclusion(random, d);
  draw_tool(random, d);
  if (chance(random, 0.4)) {
    scene.friction = random.uniform(0.05, 1.3);
    d.words += fmt::format(", mu {:.2g}", scene.friction);
  }
  scene.sampling.normal_points = 6;
  scene.sampling.tangential_depths = 2;
  scene.sampling.tangential_points = 2;
  d.cell.name = d.words;
  return d.cell;
}

}  // namespace

std::vector<BatteryCell> random_cells(std::uint64_t seed, std::size_t count) {
  std::vector<BatteryCell> cells;
  for (std::size_t k = 0; k < count; ++k) {
    // A generator of its own: a cell stays when the draw of those before it changes.
    Random random(Random(seed).bits() + k);
    cells.push_back(draw(random));
    cells.back().name = fmt::format("{}: {}", k, cells.back().name);
  }
  return cells;
}

}  // namespace palpate::verify
