// SPDX-License-Identifier: GPL-3.0-or-later
// The gradient of a quadratic tetrahedron is linear in barycentric coordinates, so that of position needs sums of
// nodes alone, shared by the four points. Energies and stresses are written in H = F - I: with terms of the size of the
// moduli that cancel at rest, the energy of a contact far smaller than the body would be rounding.
#include "precompute/fem/element_batch.hpp"

#include "precompute/fem/matrix/registers.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace palpate::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::VectorXd;
constexpr int kLanes = ElementBatch::kLanes, kPoints = kElementPoints;
constexpr double kOwn = 4 * kFarCorner - 1, kCross = 4 * kFarCorner, kExtra = 4 * (kNearCorner - kFarCorner);

// Node between two corners; the corner itself where they are one.
constexpr auto kEdgeNode = [] {
  std::array<std::array<int, 4>, 4> node{{{0, 0, 0, 0}, {1, 1, 1, 1}, {2, 2, 2, 2}, {3, 3, 3, 3}}};
  for (int e = 0; e < 6; ++e) {
    const auto [a, b] = kElementEdges[e];
    node[a][b] = node[b][a] = 4 + e;
  }
  return node;
}();

// f(0) to f(Count - 1), each a constant: the tables above cost nothing where their indices are.
template <int Count, class Function>
[[gnu::always_inline]] inline void unrolled(const Function& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, k>{}), ...);
  }
  (std::make_integer_sequence<int, Count>{});
}

// As many lanes of a batch as one register holds, from lane `first` on: wider ones would go through memory.
template <int Width>
struct Part {
  typedef double Lanes __attribute__((vector_size(Width * sizeof(double))));
  using Matrix = Lanes[9];  // by columns

  const ElementBatch& batch;
  int first;

  [[gnu::always_inline]] void read(const ElementBatch::Lanes& from, Lanes& lanes) const {
    std::memcpy(&lanes, reinterpret_cast<const double*>(&from) + first, sizeof lanes);
  }
};

template <int Width>
struct Deformation {
  typename Part<Width>::Matrix h[kPoints];         // F - I
  typename Part<Width>::Matrix cofactor[kPoints];  // of F, less I
  typename Part<Width>::Lanes dilation[kPoints];   // det F - 1
};

template <class Matrix>
[[gnu::always_inline]] inline void set_cofactor(const Matrix& f, Matrix& c) {
  for (int j = 0; j < 3; ++j) {
    const int u = 3 * ((j + 1) % 3), v = 3 * ((j + 2) % 3);
    c[3 * j] = f[u + 1] * f[v + 2] - f[u + 2] * f[v + 1];
    c[3 * j + 1] = f[u + 2] * f[v] - f[u] * f[v + 2];
    c[3 * j + 2] = f[u] * f[v + 1] - f[u + 1] * f[v];
  }
}

template <int Width>
[[gnu::always_inline]] inline void deform(const Part<Width>& part, const double* x, Deformation<Width>& d) {
  using Lanes = typename Part<Width>::Lanes;
  alignas(Lanes) double gathered[10][3][Width];
  for (int n = 0; n < 10; ++n) {
    for (int lane = 0; lane < Width; ++lane) {
      const double* at = x + 3 * std::ptrdiff_t(part.batch.nodes[n][part.first + lane]);
      for (int i = 0; i < 3; ++i) gathered[n][i][lane] = at[i];
    }
  }
  Lanes p[10][3];
  std::memcpy(p, gathered, sizeof p);
  unrolled<4>([&](auto k) __attribute__((always_inline)) {
    Lanes slopes[3];
    for (int j = 0; j < 3; ++j) part.read(part.batch.slopes[k][j], slopes[j]);
    for (int i = 0; i < 3; ++i) {
      Lanes sum{};
      unrolled<4>([&](auto j) __attribute__((always_inline)) {
        if constexpr (j != k) sum += p[kEdgeNode[k][j]][i];
      });
      sum = kCross * sum + kOwn * p[k][i];
      unrolled<kPoints>([&](auto q) __attribute__((always_inline)) {
        const Lanes along = sum + kExtra * p[kEdgeNode[k][q]][i];  // dx_i by the barycentric coordinate k at point q
        for (int j = 0; j < 3; ++j) {
          Lanes& h = d.h[q][3 * j + i];
          h = k == 0 ? along * slopes[j] : h + along * slopes[j];
        }
      });
    }
  });
  for (int q = 0; q < kPoints; ++q) {
    auto &h = d.h[q], &cofactor = d.cofactor[q];
    for (int i = 0; i < 3; ++i) h[4 * i] -= 1.0;
    typename Part<Width>::Matrix minors;
    set_cofactor(h, minors);
    const Lanes trace = h[0] + h[4] + h[8];
    d.dilation[q] =
        trace + (minors[0] + minors[4] + minors[8]) + (h[0] * minors[0] + h[1] * minors[1] + h[2] * minors[2]);
    // cof(I + H) = (1 + tr H) I - H^T + cof H
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) cofactor[3 * j + i] = minors[3 * j + i] - h[3 * i + j];
      cofactor[4 * j] += trace;
    }
  }
}

// Adds the energy of everything but the volume term, lane by lane, for batches with laws; sets the stress.
template <int Width>
[[gnu::always_inline]] inline void add_laws(const Part<Width>& part, const typename Part<Width>::Matrix& h,
                                            typename Part<Width>::Lanes& energy, typename Part<Width>::Matrix* stress) {
  for (int lane = 0; lane < Width && part.first + lane < part.batch.count; ++lane) {
    const Material& law = *part.batch.laws[part.first + lane];
    Matrix3d deformation, p;
    for (int k = 0; k < 9; ++k) deformation.data()[k] = h[k][lane] + (k % 4 == 0 ? 1.0 : 0.0);
    if (stress == nullptr) {
      energy[lane] += law.deviatoric(deformation);
      continue;
    }
    energy[lane] += law.stress(deformation, p);
    for (int k = 0; k < 9; ++k) (*stress)[k][lane] = p.data()[k];
  }
}

// Energy a volume of everything but the volume term (see ElementBatch::slope), and the mean dilatation, det F - 1, that
// this one needs.
template <int Width>
[[gnu::always_inline]] inline void distortion(const Part<Width>& part, const Deformation<Width>& d,
                                              typename Part<Width>::Lanes& energy,
                                              typename Part<Width>::Lanes& dilatation,
                                              typename Part<Width>::Matrix* stress) {
  using Lanes = typename Part<Width>::Lanes;
  energy = dilatation = Lanes{};
  Lanes mu;
  part.read(part.batch.mu, mu);
  for (int q = 0; q < kPoints; ++q) {
    dilatation += d.dilation[q];
    if (part.batch.laws[0] != nullptr) {
      if (stress != nullptr) std::fill_n(stress[q], 9, Lanes{});
      add_laws(part, d.h[q], energy, stress != nullptr ? stress + q : nullptr);
      continue;
    }
    const auto& h = d.h[q];
    Lanes square{};
    for (int k = 0; k < 9; ++k) square += h[k] * h[k];
    energy += mu * (0.5 * square + (h[0] + h[4] + h[8]) - d.dilation[q]);
    if (stress == nullptr) continue;
    for (int k = 0; k < 9; ++k) stress[q][k] = mu * (h[k] - d.cofactor[q][k]);
  }
  energy /= double(kPoints);
  dilatation /= double(kPoints);
}

// Energy (J) of the lanes in use, added to `sum`.
template <int Width>
[[gnu::always_inline]] inline void add_total(const Part<Width>& part, const Deformation<Width>& d,
                                             const typename Part<Width>::Lanes& energy,
                                             const typename Part<Width>::Lanes& dilatation, double& sum) {
  using Lanes = typename Part<Width>::Lanes;
  Lanes volume, slope, bulk, local, variance{};
  part.read(part.batch.volume, volume);
  part.read(part.batch.slope, slope);
  part.read(part.batch.bulk, bulk);
  part.read(part.batch.local, local);
  for (const Lanes& own : d.dilation) variance += (own - dilatation) * (own - dilatation);
  const Lanes all =
      volume * (energy + (slope + 0.5 * bulk * dilatation) * dilatation + local * variance * (0.5 / kPoints));
  for (int lane = 0; lane < Width && part.first + lane < part.batch.count; ++lane) sum += all[lane];
}

// Forces (N) of the elements on their nodes; `stress` is that of `distortion` and becomes the whole one.
template <int Width>
[[gnu::always_inline]] inline void set_forces(const Part<Width>& part, const Deformation<Width>& d,
                                              const typename Part<Width>::Lanes& dilatation,
                                              typename Part<Width>::Matrix* stress, double (&forces)[10][3][kLanes]) {
  using Lanes = typename Part<Width>::Lanes;
  Lanes scale, slope, bulk, local;
  part.read(part.batch.volume, scale);
  part.read(part.batch.slope, slope);
  part.read(part.batch.bulk, bulk);
  part.read(part.batch.local, local);
  scale /= double(kPoints);
  const Lanes push = slope + bulk * dilatation;
  for (int q = 0; q < kPoints; ++q) {
    const Lanes pressure = push + local * (d.dilation[q] - dilatation);
    for (int i = 0; i < 3; ++i) stress[q][4 * i] += pressure;
    for (int k = 0; k < 9; ++k) stress[q][k] = scale * (stress[q][k] + pressure * d.cofactor[q][k]);
  }
  for (int i = 0; i < 3; ++i) {
    Lanes force[10];
    unrolled<4>([&](auto k) __attribute__((always_inline)) {
      Lanes slopes[3];
      for (int j = 0; j < 3; ++j) part.read(part.batch.slopes[k][j], slopes[j]);
      Lanes traction[kPoints], all{};
      for (int q = 0; q < kPoints; ++q) {
        traction[q] = stress[q][i] * slopes[0] + stress[q][3 + i] * slopes[1] + stress[q][6 + i] * slopes[2];
        all += traction[q];
      }
      force[k] = kOwn * all + kExtra * traction[k];
      unrolled<4>([&](auto j) __attribute__((always_inline)) {
        const Lanes on_edge = kCross * all + kExtra * traction[j];
        if constexpr (j > k) force[kEdgeNode[k][j]] = on_edge;
        if constexpr (j < k) force[kEdgeNode[k][j]] += on_edge;
      });
    });
    for (int n = 0; n < 10; ++n) std::memcpy(&forces[n][i][part.first], &force[n], sizeof(Lanes));
  }
}

// `gradient` may be null. Sums run in the same order for registers of any width.
template <int Width>
[[gnu::always_inline]] inline double evaluate(const std::vector<ElementBatch>& batches, const double* x,
                                              double* gradient) {
  double sum = 0;
  for (const ElementBatch& batch : batches) {
    double of_batch = 0;
    alignas(64) double forces[10][3][kLanes];
    for (int first = 0; first < kLanes; first += Width) {
      const Part<Width> part{batch, first};
      Deformation<Width> d;
      deform(part, x, d);
      typename Part<Width>::Lanes energy, dilatation;
      typename Part<Width>::Matrix stress[kPoints];
      distortion(part, d, energy, dilatation, gradient != nullptr ? stress : nullptr);
      add_total(part, d, energy, dilatation, of_batch);
      if (gradient != nullptr) set_forces(part, d, dilatation, stress, forces);
    }
    sum += of_batch;
    if (gradient == nullptr) continue;
    for (int n = 0; n < 10; ++n) {
      for (int lane = 0; lane < batch.count; ++lane) {
        double* at = gradient + 3 * std::ptrdiff_t(batch.nodes[n][lane]);
        for (int i = 0; i < 3; ++i) at[i] += forces[n][i][lane];
      }
    }
  }
  return sum;
}

using Kernel = double (*)(const std::vector<ElementBatch>&, const double*, double*);

double evaluate_plain(const std::vector<ElementBatch>& b, const double* x, double* g) { return evaluate<2>(b, x, g); }
PALPATE_AVX2 double evaluate_avx2(const std::vector<ElementBatch>& b, const double* x, double* g) {
  return evaluate<4>(b, x, g);
}
PALPATE_AVX512 double evaluate_avx512(const std::vector<ElementBatch>& b, const double* x, double* g) {
  return evaluate<8>(b, x, g);
}

const Kernel kernel = widest<Kernel>(evaluate_plain, evaluate_avx2, evaluate_avx512);

}  // namespace

double batch_energy(const std::vector<ElementBatch>& batches, const VectorXd& x) {
  return kernel(batches, x.data(), nullptr);
}

double batch_gradient(const std::vector<ElementBatch>& batches, const VectorXd& x, VectorXd& gradient) {
  return kernel(batches, x.data(), gradient.data());
}

double batch_min_jacobian(const std::vector<ElementBatch>& batches, const VectorXd& x) {
  double smallest = std::numeric_limits<double>::max();
  for (const ElementBatch& batch : batches) {
    Deformation<kLanes> d;
    deform(Part<kLanes>{batch, 0}, x.data(), d);
    for (const auto& dilation : d.dilation) {
      for (int lane = 0; lane < batch.count; ++lane) smallest = std::min(smallest, 1 + dilation[lane]);
    }
  }
  return smallest;
}

}  // namespace palpate::fem
