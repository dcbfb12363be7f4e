// SPDX-License-Identifier: GPL-3.0-or-later
// One function a family, each a few loops over what it drives to its ends.
#include "precompute/verify/battery/stiff_cells.hpp"

#include "precompute/geometry/solids.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace palpate::verify {
namespace {

using Eigen::Vector3d;
using LawKind = MaterialScene::Law;
using Shape = ToolScene::Shape;

constexpr double kTipRadius = 0.005;  // m, of the usual tip
constexpr double kWidth = 0.06, kHeight = 0.03;

SupportScene half_space(const Vector3d& point, const Vector3d& normal) {
  SupportScene support;
  support.point = point;
  support.normal = normal;
  return support;
}

// A block whose top is z = 0, held at its bottom, under a sphere.
BatteryCell block(const std::string& family, double width = kWidth, double height = kHeight,
                  double radius = kTipRadius) {
  BatteryCell cell;
  cell.family = family;
  cell.surface = geometry::box_solid({-width / 2, -width / 2, -height}, {width / 2, width / 2, 0}, height, "block");
  cell.scene.supports = {half_space({0, 0, -height * (1 - 1e-6)}, {0, 0, 1})};
  cell.scene.tools.resize(1);
  cell.scene.tools[0].radius = radius;
  // A punch that is pushed deeper than it is long is a disc under the surface.
  cell.scene.tools[0].length = std::max(cell.scene.tools[0].length, 6 * radius);
  cell.scene.sampling.normal_points = 8;
  return cell;
}

void add(std::vector<BatteryCell>& cells, BatteryCell cell, double depth, double thickness, const std::string& name) {
  cell.depth = depth;
  cell.name = name;
  const MaterialScene& m = cell.scene.material;
  const ToolScene& tool = cell.scene.tools[0];
  cell.core = cell.core && m.young >= 10 && m.young <= 1e7 && depth <= 0.6 * thickness * (1 + 1e-9) &&
              (tool.shape == Shape::punch || tool.radius >= 3e-4);
  for (const RegionScene& r : cell.scene.regions) {
    const double contrast = r.material.young / m.young;
    cell.core = cell.core && contrast >= 0.999e-3 && contrast <= 1.001e3;
  }
  cells.push_back(std::move(cell));
}

void modulus(std::vector<BatteryCell>& cells) {
  for (const double young : {1.0, 10.0, 1e3, 1e5, 1e7, 1e9, 1e11}) {
    for (const double poisson : {0.3, 0.49, 0.4999}) {
      for (const double share : {0.2, 1.0}) {
        BatteryCell cell = block("modulus");
        cell.scene.material.young = young;
        cell.scene.material.poisson = poisson;
        add(cells, cell, share * kTipRadius, kHeight,
            fmt::format("E {:g} Pa, nu {:g}, depth {:g} R", young, poisson, share));
      }
    }
  }
}

void compressibility(std::vector<BatteryCell>& cells) {
  for (const double poisson : {0.0, 0.2, 0.45, 0.499, 0.4999}) {
    for (const Shape shape : {Shape::sphere, Shape::punch, Shape::cone}) {
      for (const double share : {0.5, 1.0}) {
        BatteryCell cell = block("compressibility");
        cell.scene.material.poisson = poisson;
        ToolScene& tool = cell.scene.tools[0];
        tool.shape = shape;
        if (shape == Shape::cone) {
          tool.radius = 1e-3;
          tool.half_angle = 1.0;
        }
        const char* name = shape == Shape::sphere ? "sphere" : shape == Shape::punch ? "punch" : "cone";
        add(cells, cell, share * kTipRadius, kHeight,
            fmt::format("nu {:g}, {}, depth {:g} mm", poisson, name, 5 * share));
      }
    }
  }
}

void layer(std::vector<BatteryCell>& cells) {
  for (const double height : {0.001, 0.0025, 0.005, 0.01, 0.02}) {
    for (const double share : {0.1, 0.3, 0.6, 0.8}) {
      for (const double poisson : {0.45, 0.49}) {
        BatteryCell cell = block("layer", 0.04, height);
        cell.scene.material.poisson = poisson;
        add(cells, cell, share * height, height,
            fmt::format("thickness {:g} mm, depth {:g} of it, nu {:g}", 1e3 * height, share, poisson));
      }
    }
  }
}

void inclusion(std::vector<BatteryCell>& cells) {
  for (const double contrast : {1e-6, 1e-3, 1e-2, 1e2, 1e3, 1e6}) {
    for (const double cover : {0.002, 0.006}) {
      for (const double size : {0.003, 0.008}) {
        for (const double depth : {0.001, 0.003}) {
          BatteryCell cell = block("inclusion");
          RegionScene lump;
          lump.name = "lump";
          lump.shape = RegionScene::Shape::ellipsoid;
          lump.centre = {0.001, 0, -cover - size};
          lump.radii = {size, size, size};
          lump.material.young = contrast * cell.scene.material.young;
          cell.scene.regions.push_back(lump);
          add(cells, cell, depth, kHeight,
              fmt::format("contrast {:g}, radius {:g} mm, {:g} mm deep, depth {:g} mm", contrast, 1e3 * size,
                          1e3 * cover, 1e3 * depth));
        }
      }
    }
  }
}

void tip(std::vector<BatteryCell>& cells) {
  for (const double radius : {2e-5, 1e-4, 3e-4, 1e-3, 5e-3, 2e-2, 0.1, 0.5}) {
    for (const double share : {0.2, 1.0}) {
      for (const double poisson : {0.45, 0.49}) {
        BatteryCell cell = block("tip", kWidth, kHeight, radius);
        cell.scene.material.poisson = poisson;
        const double depth = std::min(share * radius, share * 0.3 * kHeight);
        add(cells, cell, depth, kHeight,
            fmt::format("radius {:g} mm, depth {:g} mm, nu {:g}", 1e3 * radius, 1e3 * depth, poisson));
      }
    }
  }
}

MaterialScene material(LawKind law) {
  MaterialScene m;
  m.law = law;
  m.c10 = 600;
  m.c01 = 230;
  m.terms = {{1200, 2.5}, {-300, -4}};
  m.c1 = 250;
  m.beta = 3.4;
  m.k1 = 2e3;
  m.k2 = 5;
  m.dispersion = 0.1;
  m.fibre = {1, 0, 0};
  if (law == LawKind::linear || law == LawKind::st_venant) m.poisson = 0.4;
  m.young = small_strain_young(m);
  return m;
}

void law(std::vector<BatteryCell>& cells) {
  const std::pair<LawKind, const char*> laws[] = {{LawKind::neo_hookean, "neo-Hookean"},
                                                  {LawKind::mooney_rivlin, "Mooney-Rivlin"},
                                                  {LawKind::ogden, "Ogden"},
                                                  {LawKind::veronda_westmann, "Veronda-Westmann"},
                                                  {LawKind::holzapfel, "Holzapfel-Ogden"},
                                                  {LawKind::st_venant, "St. Venant-Kirchhoff"},
                                                  {LawKind::linear, "linear"}};
  for (const auto& [which, name] : laws) {
    for (const double share : {0.1, 0.4, 1.0, 1.6}) {
      BatteryCell cell = block("law");
      cell.scene.material = material(which);
      add(cells, cell, share * kTipRadius, kHeight, fmt::format("{}, depth {:g} R", name, share));
    }
  }
}

// Needles: the triangles at one corner of the top are cut close to it.
void sliver(std::vector<BatteryCell>& cells) {
  for (const double aspect : {10.0, 100.0, 1e3, 1e4}) {
    for (const double share : {0.2, 0.5, 1.0}) {
      BatteryCell cell = block("sliver");
      Surface& s = cell.surface;
      const double h = kWidth / aspect, w = kWidth / 2;
      s = geometry::box_solid({-w, -w, -kHeight}, {w, w, 0}, 2 * kWidth, "block");
      // Each triangle that has the corner (w, w, 0) is cut close to it, along all its edges there.
      const Vector3d corner(w, w, 0);
      const auto at = [&](const Vector3d& to) { return Vector3d(corner + h * (to - corner).normalized()); };
      Surface cut;
      cut.part_names = s.part_names;
      std::vector<Vector3d> points = s.vertices;
      const auto number = [&](const Vector3d& p) {
        for (std::size_t k = 0; k < points.size(); ++k) {
          if ((points[k] - p).norm() < 1e-12) return static_cast<std::int32_t>(k);
        }
        points.push_back(p);
        return static_cast<std::int32_t>(points.size() - 1);
      };
      for (auto t : s.triangles) {
        int k = 0;
        while (k < 3 && (s.vertices[t[k]] - corner).norm() > 1e-12) ++k;
        if (k == 3) {
          cut.triangles.push_back(t);
          continue;
        }
        const std::int32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
        const std::int32_t ab = number(at(s.vertices[b])), ac = number(at(s.vertices[c]));
        cut.triangles.push_back({a, ab, ac});
        cut.triangles.push_back({ab, b, c});
        cut.triangles.push_back({ab, c, ac});
      }
      cut.vertices = points;
      cut.parts.assign(cut.triangles.size(), 0);
      s = cut;
      add(cells, cell, share * kTipRadius, kHeight, fmt::format("aspect {:g}, depth {:g} R", aspect, share));
    }
  }
}

void membrane(std::vector<BatteryCell>& cells) {
  for (const double thickness : {0.0005, 0.001, 0.002, 0.004}) {
    for (const double share : {0.3, 0.6, 0.8}) {
      for (const double radius : {0.002, 0.005}) {
        BatteryCell cell = block("membrane", 0.04, thickness, radius);
        const double rim = 0.018;
        cell.scene.supports = {half_space({rim, 0, 0}, {-1, 0, 0}), half_space({-rim, 0, 0}, {1, 0, 0}),
                               half_space({0, rim, 0}, {0, -1, 0}), half_space({0, -rim, 0}, {0, 1, 0})};
        add(cells, cell, share * thickness, thickness,
            fmt::format("sheet of {:g} mm, depth {:g} of it, tip {:g} mm", 1e3 * thickness, share, 1e3 * radius));
      }
    }
  }
}

void friction(std::vector<BatteryCell>& cells) {
  for (const double mu : {0.1, 0.3, 0.6, 1.0, 2.0}) {
    for (const double share : {0.2, 0.6, 1.0}) {
      for (const double poisson : {0.45, 0.49}) {
        BatteryCell cell = block("friction");
        cell.scene.friction = mu;
        cell.scene.material.poisson = poisson;
        add(cells, cell, share * kTipRadius, kHeight,
            fmt::format("mu {:g}, depth {:g} R, nu {:g}", mu, share, poisson));
      }
    }
  }
}

void size(std::vector<BatteryCell>& cells) {
  for (const double width : {1e-3, 1e-2, 0.1, 1.0, 10.0}) {
    for (const Shape shape : {Shape::sphere, Shape::punch}) {
      for (const double share : {0.1, 0.5}) {
        BatteryCell cell = block("size", width, width / 2, width / 12);
        cell.scene.tools[0].shape = shape;
        add(cells, cell, share * width / 12, width / 2,
            fmt::format("block of {:g} m, {}, depth {:g} R", width, shape == Shape::sphere ? "sphere" : "punch",
                        share));
      }
    }
  }
}

// A wedge with its edge along y at the origin, pressed at a distance from the edge on its upper side.
void margin(std::vector<BatteryCell>& cells) {
  for (const double degrees : {15.0, 30.0, 60.0, 90.0}) {
    for (const double from_edge : {0.0, 0.5, 1.0, 2.0}) {
      for (const double share : {0.3, 0.6}) {
        BatteryCell cell = block("margin");
        const double angle = degrees * std::numbers::pi / 180, length = 0.04, half = 0.03;
        const bool square = degrees > 80;
        const double drop = square ? length : length * std::tan(angle);
        Surface& s = cell.surface;
        s = {};
        for (const double y : {-half, half}) {
          s.vertices.emplace_back(0, y, 0);
          s.vertices.emplace_back(length, y, 0);
          s.vertices.emplace_back(length, y, -drop);
          if (square) s.vertices.emplace_back(0, y, -length);
        }
        const int n = square ? 4 : 3;
        const auto quad = [&](int a, int b, int c, int d) {
          s.triangles.push_back({a, b, c});
          s.triangles.push_back({a, c, d});
        };
        for (int k = 0; k < n; ++k) quad(k, (k + 1) % n, (k + 1) % n + n, k + n);
        for (int k = 1; k + 1 < n; ++k) {
          s.triangles.push_back({0, k + 1, k});
          s.triangles.push_back({n, n + k, n + k + 1});
        }
        s.parts.assign(s.triangles.size(), 0);
        s.part_names = {"wedge"};
        cell.scene.supports = {half_space({0.9 * length, 0, 0}, {-1, 0, 0})};
        // The wall vanishes at the very edge. Beyond the core range a fifth of the tip's radius counts as its
        // thickness.
        const double x = from_edge * kTipRadius, wall = square ? length : x * std::tan(angle);
        const double thickness = std::max(wall, 0.2 * kTipRadius);
        cell.core = wall >= 0.2 * kTipRadius;
        cell.site = {x, 0, 0};
        const double depth = share * std::min(thickness, 2 * kTipRadius);
        add(cells, cell, depth, thickness,
            fmt::format("{:g} degrees, {:g} R from the edge, depth {:.3g} mm", degrees, from_edge, 1e3 * depth));
      }
    }
  }
}

void pointed(std::vector<BatteryCell>& cells) {
  for (const double edge : {0.005, 0.02, 0.1, 0.5}) {
    for (const double share : {0.1, 0.4}) {
      BatteryCell cell = block("pointed");
      ToolScene& tool = cell.scene.tools[0];
      tool.shape = Shape::punch;
      tool.edge_radius = edge * kTipRadius;
      add(cells, cell, share * kTipRadius, kHeight, fmt::format("punch, edge {:g} R, depth {:g} R", edge, share));
    }
  }
  for (const double half_angle : {0.1, 0.3, 0.8}) {
    for (const double radius : {1e-4, 3e-4, 1e-3}) {
      for (const double depth : {5e-4, 2e-3}) {
        BatteryCell cell = block("pointed", kWidth, kHeight, radius);
        ToolScene& tool = cell.scene.tools[0];
        tool.shape = Shape::needle;
        tool.half_angle = half_angle;
        add(cells, cell, depth, kHeight,
            fmt::format("needle, tip {:g} mm, half angle {:g}, depth {:g} mm", 1e3 * radius, half_angle, 1e3 * depth));
      }
    }
  }
}

void support(std::vector<BatteryCell>& cells) {
  for (const double stiffness : {1e2, 1e4, 1e6, 1e8, 1e10}) {
    for (const double share : {0.2, 0.8}) {
      BatteryCell cell = block("support");
      cell.scene.supports[0].type = SupportScene::Type::spring;
      cell.scene.supports[0].stiffness = stiffness;
      add(cells, cell, share * kTipRadius, kHeight, fmt::format("bed of {:g} N/m^3, depth {:g} R", stiffness, share));
    }
  }
}

}  // namespace

std::vector<BatteryCell> stiff_cells() {
  std::vector<BatteryCell> cells;
  for (const auto family : {modulus, compressibility, layer, inclusion, tip, law, sliver, membrane, friction, size,
                            margin, pointed, support}) {
    family(cells);
  }
  return cells;
}

}  // namespace palpate::verify
