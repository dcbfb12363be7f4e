// SPDX-License-Identifier: GPL-3.0-or-later
// Marching tetrahedra: six to a cell of eight voxels, along its diagonal, so that neighbours are cut alike and the
// surface is closed and manifold whatever the values.
#include "precompute/geometry/label_surface.hpp"

#include "formats/error.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr int kMargin = 3;  // voxels round the label: the smoothing reaches two
constexpr double kLeastLevel = 0.2, kMostLevel = 0.8;
constexpr double kShortest = 0.05;  // of an edge of the lattice, between its ends and the surface: no slivers

// Smoothed indicator over the label's bounding box and a margin.
class Field {
public:
  explicit Field(const LabelMask& mask) {
    std::array<int, 3> low = mask.size, high{-1, -1, -1}, at{};
    const auto each = [&](auto&& visit) {
      std::size_t k = 0;
      for (at[2] = 0; at[2] < mask.size[2]; ++at[2]) {
        for (at[1] = 0; at[1] < mask.size[1]; ++at[1]) {
          for (at[0] = 0; at[0] < mask.size[0]; ++at[0], ++k) {
            if (mask.inside[k] != 0) visit();
          }
        }
      }
    };
    each([&] {
      for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], at[a]), high[a] = std::max(high[a], at[a]);
    });
    for (std::size_t a = 0; a < 3; ++a) {
      first_[a] = low[a] - kMargin;
      size_[a] = high[a] - low[a] + 1 + 2 * kMargin;
    }
    values_.assign(std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]), 0.0F);
    each([&] { values_[number(at[0] - first_[0], at[1] - first_[1], at[2] - first_[2])] = 1.0F; });
    for (std::size_t axis = 0; axis < 3; ++axis) smooth(axis);
  }

  [[nodiscard]] std::size_t number(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(size_[1]) + std::size_t(j)) * std::size_t(size_[0]) + std::size_t(i);
  }
  [[nodiscard]] double value(std::size_t number) const { return values_[number]; }
  [[nodiscard]] const std::array<int, 3>& size() const { return size_; }
  [[nodiscard]] Vector3d index(std::size_t number) const {
    const auto nx = std::size_t(size_[0]), ny = std::size_t(size_[1]);
    return {double(number % nx) + first_[0], double(number / nx % ny) + first_[1],
            double(number / nx / ny) + first_[2]};
  }

private:
  void smooth(std::size_t axis) {
    const std::size_t step = axis == 0   ? 1
                             : axis == 1 ? std::size_t(size_[0])
                                         : std::size_t(size_[0]) * std::size_t(size_[1]);
    const std::vector<float> old = values_;
    for (std::size_t k = 2 * step; k + 2 * step < values_.size(); ++k) {
      values_[k] = (old[k - 2 * step] + old[k + 2 * step] + 4 * (old[k - step] + old[k + step]) + 6 * old[k]) / 16;
    }
  }

  std::array<int, 3> first_{}, size_{};
  std::vector<float> values_;
};

using Tet = std::array<std::size_t, 4>;

// The tetrahedra that a level between the least and the most may cut, all of one orientation in index space.
std::vector<Tet> cut_tets(const Field& field) {
  std::vector<Tet> tets;
  const auto& n = field.size();
  for (int k = 0; k + 1 < n[2]; ++k) {
    for (int j = 0; j + 1 < n[1]; ++j) {
      for (int i = 0; i + 1 < n[0]; ++i) {
        double least = 1, most = 0;  // most cells lie inside or outside as a whole
        for (int c = 0; c < 8; ++c) {
          const double value = field.value(field.number(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)));
          least = std::min(least, value);
          most = std::max(most, value);
        }
        if (!(least < kMostLevel && most > kLeastLevel)) continue;
        std::array<int, 3> axes{0, 1, 2};
        for (int turn = 0; turn < 6; ++turn, std::next_permutation(axes.begin(), axes.end())) {
          std::array<int, 3> at{i, j, k};
          Tet tet{field.number(i, j, k)};
          for (std::size_t s = 0; s < 3; ++s) {
            ++at[std::size_t(axes[s])];
            tet[s + 1] = field.number(at[0], at[1], at[2]);
          }
          const auto [low, high] = std::minmax_element(
              tet.begin(), tet.end(), [&](std::size_t a, std::size_t b) { return field.value(a) < field.value(b); });
          if (!(field.value(*low) < kMostLevel && field.value(*high) > kLeastLevel)) continue;
          // Odd permutations of the axes are mirrored.
          if (turn == 1 || turn == 2 || turn == 5) std::swap(tet[2], tet[3]);
          tets.push_back(tet);
        }
      }
    }
  }
  return tets;
}

// Where the surface cuts the edge from a corner inside to one outside.
using Cut = std::pair<std::size_t, std::size_t>;

Vector3d place(const Field& field, const LabelMask& mask, double level, const Cut& cut) {
  const double in = field.value(cut.first), out = field.value(cut.second);
  const double t = std::clamp((in - level) / (in - out), kShortest, 1 - kShortest);
  return mask.origin + mask.axes * ((1 - t) * field.index(cut.first) + t * field.index(cut.second));
}

// Calls visit(cut, cut, cut) for the triangles of the level set, outward in index space.
template <class Visit>
void for_each_triangle(const Field& field, const std::vector<Tet>& tets, double level, Visit&& visit) {
  // By the corners inside: an even permutation that brings them to the front.
  static constexpr std::uint8_t kOrder[16][4] = {
      {0, 1, 2, 3}, {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3}, {2, 3, 0, 1}, {0, 2, 3, 1}, {1, 2, 0, 3}, {0, 1, 2, 3},
      {3, 2, 1, 0}, {0, 3, 1, 2}, {1, 3, 2, 0}, {0, 3, 1, 2}, {2, 3, 0, 1}, {0, 2, 3, 1}, {1, 3, 2, 0}, {0, 1, 2, 3}};
  for (const Tet& tet : tets) {
    unsigned inside = 0;
    for (unsigned c = 0; c < 4; ++c) inside |= field.value(tet[c]) > level ? 1U << c : 0U;
    const auto& order = kOrder[inside];
    const std::size_t a = tet[order[0]], b = tet[order[1]], c = tet[order[2]], d = tet[order[3]];
    switch (std::popcount(inside)) {
      case 1:
        visit(Cut{a, b}, Cut{a, c}, Cut{a, d});
        break;
      case 2:
        visit(Cut{a, c}, Cut{a, d}, Cut{b, d});
        visit(Cut{a, c}, Cut{b, d}, Cut{b, c});
        break;
      case 3:
        visit(Cut{a, d}, Cut{b, d}, Cut{c, d});
        break;
      default:
        break;
    }
  }
}

double enclosed(const Field& field, const std::vector<Tet>& tets, const LabelMask& mask, double level) {
  double six = 0;
  for_each_triangle(field, tets, level, [&](const Cut& a, const Cut& b, const Cut& c) {
    const auto at = [&](const Cut& cut) -> Vector3d { return place(field, mask, level, cut) - mask.origin; };
    six += at(a).dot(at(b).cross(at(c)));
  });
  return std::abs(six) / 6;
}

Surface level_set(const Field& field, const std::vector<Tet>& tets, const LabelMask& mask, double level) {
  Surface surface;
  std::map<Cut, std::int32_t> numbers;
  const auto vertex = [&](const Cut& cut) {
    const auto [at, fresh] = numbers.try_emplace(cut, static_cast<std::int32_t>(surface.vertices.size()));
    if (fresh) surface.vertices.push_back(place(field, mask, level, cut));
    return at->second;
  };
  const bool mirrored = mask.axes.determinant() < 0;
  for_each_triangle(field, tets, level, [&](const Cut& a, const Cut& b, const Cut& c) {
    const std::int32_t first = vertex(a), second = vertex(b), third = vertex(c);
    surface.triangles.push_back({first, mirrored ? third : second, mirrored ? second : third});
  });
  surface.parts.assign(surface.triangles.size(), 0);
  return surface;
}

}  // namespace

Surface label_surface(const LabelMask& mask, const std::string& name) {
  const Field field(mask);
  const std::vector<Tet> tets = cut_tets(field);
  const double wanted = double(mask.count) * std::abs(mask.axes.determinant());
  const auto excess = [&](double level) { return enclosed(field, tets, mask, level) - wanted; };
  double low = kLeastLevel, high = kMostLevel;
  if (!(excess(low) > 0 && excess(high) < 0)) {
    throw Error(ExitCode::bad_input, name + ": its " + std::to_string(mask.count) +
                                         " voxels are too thin to have a surface; allowed: parts at least about two "
                                         "voxels thick");
  }
  for (int k = 0; k < 14; ++k) {
    const double middle = (low + high) / 2;
    (excess(middle) > 0 ? low : high) = middle;
  }
  Surface surface = level_set(field, tets, mask, (low + high) / 2);
  surface.part_names = {"label"};  // no path: it is hashed into the plan
  return surface;
}

}  // namespace palpate
