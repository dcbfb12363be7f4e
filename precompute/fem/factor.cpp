// SPDX-License-Identifier: GPL-3.0-or-later
// CHOLMOD's supernodal factor, and triangular solves on a copy of it in single precision.
#include "precompute/fem/factor.hpp"

#include <cholmod.h>
#include <algorithm>
#include <mutex>
#include <new>
#include <vector>

namespace palpate {
namespace {

using Eigen::VectorXd;
using Eigen::VectorXf;

// METIS seeds and draws from the process's one rand(): two threads ordering at once would mix their draws, and
// the order of elimination (so the last bits of every solve) would depend on the scheduler.
std::mutex& ordering() {
  static std::mutex mutex;
  return mutex;
}

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

  void forward(VectorXf& y, VectorXf& work) const;
  void backward(VectorXf& y, VectorXf& work) const;

  // CHOLMOD's workspace, which solves write to: one object belongs to one thread.
  mutable cholmod_common common{};
  cholmod_factor* factor = nullptr;
  std::vector<float> values;  // of the factor
  Eigen::Index tallest = 0;   // rows of a supernode
};

namespace {

// The columns of one supernode: a triangle on top of a panel.
struct Supernode {
  Supernode(const cholmod_factor& f, const float* all, std::size_t s) {
    const auto *super = static_cast<const int*>(f.super), *pi = static_cast<const int*>(f.pi),
               *px = static_cast<const int*>(f.px);
    first = super[s];
    columns = super[s + 1] - first;
    height = pi[s + 1] - pi[s];
    rows = static_cast<const int*>(f.s) + pi[s] + columns;
    values = all + px[s];
  }
  using Block = Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>>;
  [[nodiscard]] Block triangle() const { return {values, columns, columns, Eigen::OuterStride<>(height)}; }
  [[nodiscard]] Block panel() const { return {values + columns, below(), columns, Eigen::OuterStride<>(height)}; }
  [[nodiscard]] int below() const { return height - columns; }

  int first, columns, height;
  const int* rows;  // of the panel
  const float* values;
};

}  // namespace

void Factor::Impl::forward(VectorXf& y, VectorXf& work) const {
  for (std::size_t s = 0; s < factor->nsuper; ++s) {
    const Supernode n(*factor, values.data(), s);
    auto top = y.segment(n.first, n.columns);
    n.triangle().triangularView<Eigen::Lower>().solveInPlace(top);
    auto gathered = work.head(n.below());
    gathered.noalias() = n.panel() * top;
    for (int k = 0; k < n.below(); ++k) y[n.rows[k]] -= gathered[k];
  }
}

void Factor::Impl::backward(VectorXf& y, VectorXf& work) const {
  for (std::size_t s = factor->nsuper; s-- > 0;) {
    const Supernode n(*factor, values.data(), s);
    auto top = y.segment(n.first, n.columns);
    auto gathered = work.head(n.below());
    for (int k = 0; k < n.below(); ++k) gathered[k] = y[n.rows[k]];
    top.noalias() -= n.panel().transpose() * gathered;
    n.triangle().transpose().triangularView<Eigen::Upper>().solveInPlace(top);
  }
}

Factor::Factor(const Matrix& lower) : impl_(std::make_unique<Impl>()) {
  cholmod_sparse view = view_of(lower);
  const std::scoped_lock lock(ordering());
  impl_->factor = cholmod_analyze(&view, &impl_->common);
  if (impl_->factor == nullptr) throw std::bad_alloc();
  const auto* pi = static_cast<const int*>(impl_->factor->pi);
  for (std::size_t s = 0; s < impl_->factor->nsuper; ++s) {
    impl_->tallest = std::max<Eigen::Index>(impl_->tallest, pi[s + 1] - pi[s]);
  }
}

Factor::~Factor() = default;

bool Factor::factorise(const Matrix& lower) {
  cholmod_sparse view = view_of(lower);
  cholmod_factorize(&view, impl_->factor, &impl_->common);
  if (impl_->common.status != CHOLMOD_OK || impl_->factor->minor < impl_->factor->n) return false;
  const auto* x = static_cast<const double*>(impl_->factor->x);
  impl_->values.assign(x, x + impl_->factor->xsize);
  return true;
}

VectorXd Factor::solve(const VectorXd& b) const {
  cholmod_dense right{};
  right.nrow = right.d = right.nzmax = static_cast<std::size_t>(b.size());
  right.ncol = 1;
  right.x = const_cast<double*>(b.data());
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, impl_->factor, &right, &impl_->common);
  if (x == nullptr) throw std::bad_alloc();
  VectorXd result = Eigen::Map<const VectorXd>(static_cast<const double*>(x->x), b.size());
  cholmod_free_dense(&x, &impl_->common);
  return result;
}

VectorXd Factor::solve_single(const VectorXd& b) const {
  const Eigen::Map<const Eigen::VectorXi> order(static_cast<const int*>(impl_->factor->Perm), b.size());
  // Forces of millinewtons on stiffnesses of any size: scaled, they stay far from the ends of a float's range.
  const double scale = b.cwiseAbs().maxCoeff();
  if (!(scale > 0)) return VectorXd::Zero(b.size());
  VectorXf y = (b(order) / scale).cast<float>(), work(impl_->tallest);
  impl_->forward(y, work);
  impl_->backward(y, work);
  VectorXd x(b.size());
  x(order) = scale * y.cast<double>();
  return x;
}

double Factor::single_error(const VectorXd& b) const {
  const VectorXd x = solve(b);
  const double size = x.norm();
  return size > 0 ? (solve_single(b) - x).norm() / size : 0.0;
}

}  // namespace palpate
