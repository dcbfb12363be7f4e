// SPDX-License-Identifier: GPL-3.0-or-later
// CHOLMOD orders and analyses; it factorises where single precision does not do.
#include "precompute/fem/matrix/factor.hpp"

#include "formats/io/error.hpp"
#include "precompute/fem/matrix/ordering.hpp"
#include "precompute/fem/matrix/single_cholesky.hpp"

#include <cholmod.h>
#include <cstdio>
#include <limits>
#include <new>
#include <optional>
#include <vector>

namespace palpate::fem {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Relative error up to which a solve in single precision preconditions as well as one in double.
constexpr double kSingleError = 0.02;

cholmod_sparse view_of(const Factor::Matrix& lower) {
  cholmod_sparse view{};
  view.nrow = static_cast<std::size_t>(lower.rows());
  view.ncol = static_cast<std::size_t>(lower.cols());
  view.nzmax = static_cast<std::size_t>(lower.nonZeros());
  view.p = const_cast<int*>(lower.outerIndexPtr());
  view.i = const_cast<int*>(lower.innerIndexPtr());
  view.x = const_cast<double*>(lower.valuePtr());
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

}  // namespace

struct Factor::Impl {
  using Matrix = Factor::Matrix;

  Impl() {
    cholmod_start(&common);
    // One ordering, no trial of several: the choice must not depend on anything but the mesh.
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.postorder = 1;
    common.print = 0;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_asis = 1;
  }
  ~Impl() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] bool factorise(const Matrix& lower);
  [[nodiscard]] MatrixXd solve(const MatrixXd& b) const;

  // CHOLMOD's workspace, which solves write to: one object belongs to one thread.
  mutable cholmod_common common{};
  cholmod_factor* factor = nullptr;
  std::optional<SingleCholesky> in_single;
  bool single = false;
};

namespace {

SupernodalPattern pattern_of(const cholmod_factor& f) {
  const auto copy = [](const void* from, std::size_t count) {
    const auto* const first = static_cast<const int*>(from);
    return std::vector<int>(first, first + count);
  };
  return {copy(f.Perm, f.n), copy(f.super, f.nsuper + 1), copy(f.pi, f.nsuper + 1), copy(f.px, f.nsuper + 1),
          copy(f.s, f.ssize)};
}

// Error of a solve over the solution, by what one step of refinement would change.
double relative_error(const SingleCholesky& factor, const Factor::Matrix& lower, const VectorXd& b) {
  const VectorXd x = factor.solve(b);
  if (!x.allFinite()) return std::numeric_limits<double>::infinity();
  const double size = x.norm();
  const VectorXd residual = b - lower.selfadjointView<Eigen::Lower>() * x;
  return size > 0 ? factor.solve(residual).norm() / size : 0.0;
}

}  // namespace

bool Factor::Impl::factorise(const Matrix& lower) {
  cholmod_sparse view = view_of(lower);
  cholmod_factorize(&view, factor, &common);
  return common.status == CHOLMOD_OK && factor->minor >= factor->n;
}

MatrixXd Factor::Impl::solve(const MatrixXd& b) const {
  cholmod_dense right{};
  right.nrow = right.d = static_cast<std::size_t>(b.rows());
  right.ncol = static_cast<std::size_t>(b.cols());
  right.nzmax = static_cast<std::size_t>(b.size());
  right.x = const_cast<double*>(b.data());
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor, &right, &common);
  if (x == nullptr) throw std::bad_alloc();
  MatrixXd result = Eigen::Map<const MatrixXd>(static_cast<const double*>(x->x), b.rows(), b.cols());
  cholmod_free_dense(&x, &common);
  return result;
}

Factor::Factor(const Matrix& lower, double most_bytes) : impl_(std::make_unique<Impl>()) {
  cholmod_sparse view = view_of(lower);
  impl_->factor = order_and_analyse(view, impl_->common);
  if (impl_->factor == nullptr) throw std::bad_alloc();
  const double bytes = static_cast<double>(impl_->factor->xsize) * (sizeof(float) + sizeof(double));
  if (bytes > most_bytes) {
    char text[96];
    std::snprintf(text, sizeof text, "memory: the factor of %td equations takes %.1f MB, allowed %.1f MB",
                  std::ptrdiff_t(lower.rows()), 1e-6 * bytes, 1e-6 * most_bytes);
    throw Error(ExitCode::numerical, text);
  }
  impl_->in_single.emplace(lower, pattern_of(*impl_->factor));
}

Factor::~Factor() = default;

bool Factor::factorise(const Matrix& lower, const VectorXd& load) {
  SingleCholesky& single = *impl_->in_single;
  impl_->single = single.factorise(lower) && relative_error(single, lower, load) < kSingleError;
  return impl_->single || impl_->factorise(lower);
}

bool Factor::single() const { return impl_->single; }

bool Factor::factorise_double(const Matrix& lower) {
  impl_->single = false;
  return impl_->factorise(lower);
}

MatrixXd Factor::solve_all(const MatrixXd& b) const { return impl_->solve(b); }

VectorXd Factor::solve(const VectorXd& b) const {
  if (impl_->single) return impl_->in_single->solve(b);
  return impl_->solve(b);
}

}  // namespace palpate::fem
