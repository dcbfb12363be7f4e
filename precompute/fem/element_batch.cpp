// SPDX-License-Identifier: GPL-3.0-or-later
// The gradient of a quadratic tetrahedron is linear in barycentric coordinates, so that of position needs sums of
// nodes alone (`Sums`), shared by the four points.
#include "precompute/fem/element_batch.hpp"

#include "precompute/fem/registers.hpp"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

using Eigen::Matrix3d;
using Eigen::VectorXd;
using Lanes = ElementBatch::Lanes;
constexpr int kLanes = ElementBatch::kLanes, kPoints = kElementPoints;
constexpr double kOwn = 4 * kFarCorner - 1, kCross = 4 * kFarCorner, kExtra = 4 * (kNearCorner - kFarCorner);

using Matrix = Lanes[9];  // by columns
using Nodes = Lanes[10][3];

// Node between two corners.
constexpr int edge_node(int a, int b) {
  for (int e = 0; e < 6; ++e) {
    if ((kElementEdges[e][0] == a && kElementEdges[e][1] == b) ||
        (kElementEdges[e][0] == b && kElementEdges[e][1] == a)) {
      return 4 + e;
    }
  }
  return a;
}

struct Deformation {
  Matrix f[kPoints], cofactor[kPoints];
  Lanes det[kPoints];
};

[[gnu::always_inline]] inline void cofactor(const Matrix& f, Matrix& c) {
  for (int j = 0; j < 3; ++j) {
    const int u = 3 * ((j + 1) % 3), v = 3 * ((j + 2) % 3);
    c[3 * j] = f[u + 1] * f[v + 2] - f[u + 2] * f[v + 1];
    c[3 * j + 1] = f[u + 2] * f[v] - f[u] * f[v + 2];
    c[3 * j + 2] = f[u] * f[v + 1] - f[u + 1] * f[v];
  }
}

[[gnu::always_inline]] inline void deform(const ElementBatch& batch, const double* x, Deformation& d) {
  Nodes p;
  for (int n = 0; n < 10; ++n) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const double* at = x + 3 * std::ptrdiff_t(batch.nodes[n][lane]);
      for (int i = 0; i < 3; ++i) p[n][i][lane] = at[i];
    }
  }
  for (Matrix& f : d.f) std::fill_n(f, 9, Lanes{});
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < 3; ++i) {
      Lanes sum{};
      for (int j = 0; j < 4; ++j) {
        if (j != k) sum += p[edge_node(k, j)][i];
      }
      sum = kCross * sum + kOwn * p[k][i];
      for (int q = 0; q < kPoints; ++q) {
        const Lanes along = sum + kExtra * p[edge_node(k, q)][i];  // dx_i by the barycentric coordinate k at point q
        for (int j = 0; j < 3; ++j) d.f[q][3 * j + i] += along * batch.slopes[k][j];
      }
    }
  }
  for (int q = 0; q < kPoints; ++q) {
    cofactor(d.f[q], d.cofactor[q]);
    d.det[q] = d.f[q][0] * d.cofactor[q][0] + d.f[q][1] * d.cofactor[q][1] + d.f[q][2] * d.cofactor[q][2];
  }
}

// Adds the energy of everything but the volume term, lane by lane, for batches with laws; sets the stress.
void add_laws(const ElementBatch& batch, const Matrix& f, Lanes& energy, Matrix* stress) {
  for (int lane = 0; lane < batch.count; ++lane) {
    Matrix3d deformation, p;
    for (int k = 0; k < 9; ++k) deformation.data()[k] = f[k][lane];
    if (stress == nullptr) {
      energy[lane] += batch.laws[lane]->deviatoric(deformation);
      continue;
    }
    energy[lane] += batch.laws[lane]->stress(deformation, p);
    for (int k = 0; k < 9; ++k) (*stress)[k][lane] = p.data()[k];
  }
}

// Energy a volume of everything but the volume term, and the mean dilatation that this one needs.
[[gnu::always_inline]] inline void distortion(const ElementBatch& batch, const Deformation& d, Lanes& energy,
                                              Lanes& dilatation, Matrix* stress) {
  energy = dilatation = Lanes{};
  for (int q = 0; q < kPoints; ++q) {
    dilatation += d.det[q];
    if (batch.laws[0] != nullptr) {
      add_laws(batch, d.f[q], energy, stress != nullptr ? stress + q : nullptr);
      continue;
    }
    Lanes square{};
    for (int k = 0; k < 9; ++k) square += d.f[q][k] * d.f[q][k];
    energy += 0.5 * batch.mu * (square - 3.0);
    if (stress == nullptr) continue;
    for (int k = 0; k < 9; ++k) stress[q][k] = batch.mu * d.f[q][k];
  }
  energy /= double(kPoints);
  dilatation /= double(kPoints);
}

// Energy (J) of the lanes in use.
[[gnu::always_inline]] inline double total(const ElementBatch& batch, const Deformation& d, const Lanes& energy,
                                           const Lanes& dilatation) {
  const Lanes change = dilatation - 1.0;
  Lanes variance{};
  for (const Lanes& det : d.det) variance += (det - dilatation) * (det - dilatation);
  const Lanes all = batch.volume * (energy + (batch.slope + 0.5 * batch.bulk * change) * change +
                                    batch.local * variance * (0.5 / kPoints));
  double sum = 0;
  for (int lane = 0; lane < batch.count; ++lane) sum += all[lane];
  return sum;
}

// `gradient` may be null.
[[gnu::always_inline]] inline double evaluate(const std::vector<ElementBatch>& batches, const double* x,
                                              double* gradient) {
  double sum = 0;
  for (const ElementBatch& batch : batches) {
    Deformation d;
    deform(batch, x, d);
    Lanes energy, dilatation;
    Matrix stress[kPoints] = {};
    distortion(batch, d, energy, dilatation, gradient != nullptr ? stress : nullptr);
    sum += total(batch, d, energy, dilatation);
    if (gradient == nullptr) continue;

    const Lanes scale = batch.volume / double(kPoints), push = batch.slope + batch.bulk * (dilatation - 1.0);
    for (int q = 0; q < kPoints; ++q) {
      const Lanes pressure = push + batch.local * (d.det[q] - dilatation);
      for (int k = 0; k < 9; ++k) stress[q][k] = scale * (stress[q][k] + pressure * d.cofactor[q][k]);
    }
    Nodes force = {};
    for (int k = 0; k < 4; ++k) {
      for (int i = 0; i < 3; ++i) {
        Lanes traction[kPoints];
        Lanes all{};
        for (int q = 0; q < kPoints; ++q) {
          traction[q] = stress[q][i] * batch.slopes[k][0] + stress[q][3 + i] * batch.slopes[k][1] +
                        stress[q][6 + i] * batch.slopes[k][2];
          all += traction[q];
        }
        force[k][i] += kOwn * all + kExtra * traction[k];
        for (int j = 0; j < 4; ++j) {
          if (j != k) force[edge_node(k, j)][i] += kCross * all + kExtra * traction[j];
        }
      }
    }
    for (int n = 0; n < 10; ++n) {
      for (int lane = 0; lane < batch.count; ++lane) {
        double* at = gradient + 3 * std::ptrdiff_t(batch.nodes[n][lane]);
        for (int i = 0; i < 3; ++i) at[i] += force[n][i][lane];
      }
    }
  }
  return sum;
}

using Kernel = double (*)(const std::vector<ElementBatch>&, const double*, double*);

double evaluate_plain(const std::vector<ElementBatch>& b, const double* x, double* g) { return evaluate(b, x, g); }
PALPATE_AVX2 double evaluate_avx2(const std::vector<ElementBatch>& b, const double* x, double* g) {
  return evaluate(b, x, g);
}
PALPATE_AVX512 double evaluate_avx512(const std::vector<ElementBatch>& b, const double* x, double* g) {
  return evaluate(b, x, g);
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
    Deformation d;
    deform(batch, x.data(), d);
    for (const Lanes& det : d.det) {
      for (int lane = 0; lane < batch.count; ++lane) smallest = std::min(smallest, det[lane]);
    }
  }
  return smallest;
}

}  // namespace palpate
