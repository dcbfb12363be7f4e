// SPDX-License-Identifier: GPL-3.0-or-later
// Marching tetrahedra: six to a cell of eight voxels, along its diagonal, so that neighbours are cut alike and the
// surface is closed and manifold whatever the values.
#include "precompute/geometry/label_surface.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/topology.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr int kMargin = 3;  // voxels round the label: the smoothing reaches two
constexpr double kLeastLevel = 0.2, kMostLevel = 0.8;
constexpr double kShortest = 0.05;  // of an edge of the lattice, between its ends and the surface: no slivers
// Lattice steps along the edge of a cube of the label's volume: some 60 000 triangles. A finer image is resampled to
// it.
constexpr double kSteps = 40;
constexpr double kSameStep = 0.25;   // relative difference below which an axis keeps its voxels
constexpr double kThickSlice = 1.5;  // of the other axes' steps: slices that far apart are interpolated by shape
constexpr double kRamp = 4;          // voxels in the slice over which the signed distance becomes a share
constexpr std::size_t kMostPoints = 60'000'000;  // of the lattice

// Smoothed indicator on a lattice over the label's bounding box and a margin. The lattice has about equal steps along
// the axes, whatever the voxels have.
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
    const Vector3d spacing = mask.axes.colwise().norm();
    const double volume = double(mask.count) * std::abs(mask.axes.determinant());
    double step = std::max(spacing.minCoeff(), std::cbrt(volume) / kSteps);
    std::array<int, 3> voxels{};
    for (std::size_t a = 0; a < 3; ++a) {
      first_[a] = low[a] - kMargin;
      voxels[a] = high[a] - low[a] + 1 + 2 * kMargin;
    }
    choose_steps(spacing, voxels, step);
    size_ = voxels;
    values_.assign(std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]), 0.0F);
    each([&] { values_[number(at[0] - first_[0], at[1] - first_[1], at[2] - first_[2])] = 1.0F; });
    const std::size_t thick = thick_axis(spacing);
    if (thick < 3) to_distances(thick, spacing);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // Each pass adds a variance of one squared voxel; a coarser lattice wants the finer details gone.
      const int passes = std::max(1, int(std::lround(steps_[axis] * steps_[axis] / 2)));
      for (int pass = 0; axis != thick && pass < passes; ++pass) smooth(axis);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) resample(axis);
    if (thick == 3) return;
    const double ramp = kRamp * spacing[int(thick == 0 ? 1 : 0)];
    for (float& v : values_) v = float(std::clamp(0.5 + v / ramp, 0.0, 1.0));
  }

  [[nodiscard]] std::size_t number(int i, int j, int k) const {
    return (std::size_t(k) * std::size_t(size_[1]) + std::size_t(j)) * std::size_t(size_[0]) + std::size_t(i);
  }
  [[nodiscard]] double value(std::size_t number) const { return values_[number]; }
  [[nodiscard]] const std::array<int, 3>& size() const { return size_; }
  /// Voxel indices of a point of the lattice.
  [[nodiscard]] Vector3d index(std::size_t number) const {
    const auto nx = std::size_t(size_[0]), ny = std::size_t(size_[1]);
    return {double(number % nx) * steps_[0] + first_[0], double(number / nx % ny) * steps_[1] + first_[1],
            double(number / nx / ny) * steps_[2] + first_[2]};
  }

private:
  void choose_steps(const Vector3d& spacing, const std::array<int, 3>& voxels, double step) {
    for (;; step *= 1.1) {
      double points = 1;
      for (std::size_t a = 0; a < 3; ++a) {
        steps_[a] = step / spacing[int(a)];
        if (std::abs(steps_[a] - 1) < kSameStep) steps_[a] = 1;
        points *= voxels[a] / steps_[a];
      }
      if (points <= double(kMostPoints)) return;
    }
  }

  [[nodiscard]] std::size_t stride(std::size_t axis) const {
    return axis == 0 ? 1 : axis == 1 ? std::size_t(size_[0]) : std::size_t(size_[0]) * std::size_t(size_[1]);
  }

  // The axis across slices that lie far apart; 3: none.
  static std::size_t thick_axis(const Vector3d& spacing) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double others = std::max(spacing[int((a + 1) % 3)], spacing[int((a + 2) % 3)]);
      if (spacing[int(a)] > kThickSlice * others) return a;
    }
    return 3;
  }

  // Squared distances (m^2) along one axis from squared distances so far: the lower envelope of parabolas (Felzenszwalb
  // and Huttenlocher 2012).
  void spread(std::vector<float>& squares, std::size_t axis, double spacing) const {
    const auto n = std::size_t(size_[axis]);
    const std::size_t step = stride(axis), row = step * n;
    std::vector<double> f(n), z(n + 1);
    std::vector<std::size_t> v(n);
    for (std::size_t start = 0; start < squares.size(); ++start) {
      if (start % row >= step) continue;  // not the first of its line
      for (std::size_t q = 0; q < n; ++q) f[q] = squares[start + q * step] / (spacing * spacing);
      std::size_t k = 0;
      v[0] = 0;
      z[0] = -1e30;
      z[1] = 1e30;
      for (std::size_t q = 1; q < n; ++q) {
        const auto meet = [&](std::size_t p) {
          return ((f[q] + double(q * q)) - (f[p] + double(p * p))) / (2.0 * double(q - p));
        };
        double s = meet(v[k]);
        while (k > 0 && s <= z[k]) s = meet(v[--k]);
        v[++k] = q;
        z[k] = s;
        z[k + 1] = 1e30;
      }
      k = 0;
      for (std::size_t q = 0; q < n; ++q) {
        while (z[k + 1] < double(q)) ++k;
        const double d = double(q) - double(v[k]);
        squares[start + q * step] = float((d * d + f[v[k]]) * spacing * spacing);
      }
    }
  }

  // Signed distances in every slice (m, positive inside). Interpolated across the slices, they give the shapes between
  // two outlines, where shares would give one step from the one to the other.
  void to_distances(std::size_t thick, const Vector3d& spacing) {
    constexpr float kFar = 1e6F;  // m^2; a slice without any voxel of the kind
    std::vector<float> inside(values_.size()), outside(values_.size());
    for (std::size_t k = 0; k < values_.size(); ++k) {
      inside[k] = values_[k] > 0 ? kFar : 0.0F;
      outside[k] = values_[k] > 0 ? 0.0F : kFar;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (axis == thick) continue;
      spread(inside, axis, spacing[int(axis)]);
      spread(outside, axis, spacing[int(axis)]);
    }
    // Between centres on both sides of an outline lies half a voxel each. Beyond its last slice an organ goes on for
    // about half a slice: there the distance is that to the middle of the slice before.
    const auto half = float(0.25 * (spacing.sum() - spacing[int(thick)]));
    const auto empty = -float(spacing[int(thick)]);
    for (std::size_t k = 0; k < values_.size(); ++k) {
      if (values_[k] > 0) {
        values_[k] = std::sqrt(inside[k]) - half;
      } else {
        values_[k] = outside[k] > kFar / 4 ? empty : std::max(empty * 4, half - std::sqrt(outside[k]));
      }
    }
  }

  // Binomial weights 1 4 6 4 1.
  void smooth(std::size_t axis) {
    const std::size_t step = stride(axis);
    const std::vector<float> old = values_;
    for (std::size_t k = 2 * step; k + 2 * step < values_.size(); ++k) {
      values_[k] = (old[k - 2 * step] + old[k + 2 * step] + 4 * (old[k - step] + old[k + step]) + 6 * old[k]) / 16;
    }
  }

  // Linear interpolation along one axis.
  void resample(std::size_t axis) {
    if (steps_[axis] == 1) return;
    const std::array<int, 3> old_size = size_;
    const std::size_t step = stride(axis), before = step, row = step * std::size_t(old_size[axis]);
    const std::vector<float> old = std::move(values_);
    size_[axis] = int(std::floor((old_size[axis] - 1) / steps_[axis])) + 1;
    values_.assign(old.size() / std::size_t(old_size[axis]) * std::size_t(size_[axis]), 0.0F);
    for (std::size_t block = 0; block < old.size() / row; ++block) {
      for (int i = 0; i < size_[axis]; ++i) {
        const double at = i * steps_[axis];
        const auto low = std::min(std::size_t(at), std::size_t(old_size[axis]) - 2);
        const auto share = float(at - double(low));
        const float* from = old.data() + block * row + low * step;
        float* to = values_.data() + (block * std::size_t(size_[axis]) + std::size_t(i)) * before;
        for (std::size_t k = 0; k < before; ++k) to[k] = (1 - share) * from[k] + share * from[k + step];
      }
    }
  }

  std::array<int, 3> first_{}, size_{};
  std::array<double, 3> steps_{1, 1, 1};  // voxels from one point of the lattice to the next
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

// A cut of the surface with the edge from a corner inside to one outside.
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

// Fairing. Taubin's filter (1995) with these two weights keeps waves longer than some 20 edges and removes shorter
// ones, without shrinking. A vertex stays within half a voxel of where the voxels put it: any surface there has the
// same voxels.
constexpr double kShrink = 0.5, kInflate = -0.52;
constexpr int kRounds = 60;
constexpr double kFree = 0.5;  // voxels, along each axis

class Fairing {
public:
  Fairing(Surface& surface, const LabelMask& mask)
      : surface_(surface), start_(surface.vertices), to_index_(mask.axes.inverse()), to_place_(mask.axes) {
    std::vector<std::int32_t> counts(surface.vertices.size() + 1, 0);
    for (const auto& t : surface.triangles) {
      for (const auto v : t) ++counts[std::size_t(v) + 1];
    }
    for (std::size_t v = 1; v < counts.size(); ++v) counts[v] += counts[v - 1];
    first_ = counts;
    neighbours_.resize(std::size_t(counts.back()));
    // Closed and manifold: the second corner of every triangle at a vertex is each of its neighbours once.
    for (const auto& t : surface.triangles) {
      for (std::size_t k = 0; k < 3; ++k) neighbours_[std::size_t(counts[std::size_t(t[k])]++)] = t[(k + 1) % 3];
    }
  }

  void run() {
    for (int round = 0; round < kRounds; ++round) {
      step(kShrink);
      step(kInflate);
    }
  }

  // Back to where the voxels put it, within two edges of these triangles.
  void undo(const std::vector<std::size_t>& triangles) {
    std::vector<char> near(start_.size(), 0);
    for (const auto t : triangles) {
      for (const auto v : surface_.triangles[t]) near[std::size_t(v)] = 1;
    }
    for (int ring = 0; ring < 2; ++ring) {
      std::vector<char> wider = near;
      for (std::size_t v = 0; v < near.size(); ++v) {
        if (near[v] == 0) continue;
        for (auto n = first_[v]; n < first_[v + 1]; ++n) wider[std::size_t(neighbours_[std::size_t(n)])] = 1;
      }
      near = wider;
    }
    for (std::size_t v = 0; v < near.size(); ++v) {
      if (near[v] != 0) surface_.vertices[v] = start_[v];
    }
  }

private:
  void step(double weight) {
    const std::vector<Vector3d> old = surface_.vertices;
    for (std::size_t v = 0; v < old.size(); ++v) {
      Vector3d mean(0, 0, 0);
      for (auto n = first_[v]; n < first_[v + 1]; ++n) mean += old[std::size_t(neighbours_[std::size_t(n)])];
      mean /= double(first_[v + 1] - first_[v]);
      const Vector3d moved = to_index_ * (old[v] + weight * (mean - old[v]) - start_[v]);
      const double reach = moved.cwiseAbs().maxCoeff();
      surface_.vertices[v] = start_[v] + to_place_ * (reach > kFree ? Vector3d(moved * (kFree / reach)) : moved);
    }
  }

  Surface& surface_;
  std::vector<Vector3d> start_;
  Eigen::Matrix3d to_index_, to_place_;
  std::vector<std::int32_t> first_, neighbours_;
};

// Moves every vertex along its normal by the same length, so that the surface encloses `wanted` (m^3).
void set_volume(Surface& surface, double wanted) {
  for (int round = 0; round < 3; ++round) {
    std::vector<Vector3d> normals(surface.vertices.size(), Vector3d::Zero());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      const Vector3d n = triangle_normal(surface, t);
      for (const auto v : surface.triangles[t]) normals[std::size_t(v)] += n;
    }
    const double length = (wanted - signed_volume(surface)) / area(surface);
    for (std::size_t v = 0; v < normals.size(); ++v) surface.vertices[v] += length * normals[v].stableNormalized();
  }
}

void fair(Surface& surface, const LabelMask& mask, double wanted) {
  const Surface unfaired = surface;
  Fairing fairing(surface, mask);
  fairing.run();
  set_volume(surface, wanted);
  for (int attempt = 0; attempt < 3; ++attempt) {
    std::vector<std::size_t> crossing;
    for (const auto& [a, b] : crossings(surface)) {
      crossing.push_back(std::size_t(a));
      crossing.push_back(std::size_t(b));
    }
    if (crossing.empty()) return;
    fairing.undo(crossing);
  }
  surface = unfaired;
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
  fair(surface, mask, wanted);
  surface.part_names = {"label"};  // no path: it is hashed into the plan
  return surface;
}

}  // namespace palpate::geometry
