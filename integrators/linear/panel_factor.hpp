/// The factors of a sparse symmetric matrix, panel by panel.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

#include <Eigen/SparseCore>

#include "core/parallel_for.hpp"
#include "core/process/heap.hpp"
#include "integrators/linear/panel_analysis.hpp"
#include "integrators/linear/panel_kernels.hpp"
#include "integrators/linear/panel_loops.hpp"

namespace hmax {

namespace detail {
/// One number at a time, for scalars without kernels of their own.
template <class ScalarT>
struct SingleLane {
  using Scalar = ScalarT;
  /// Width of a register, tile of columns and registers.
  static constexpr int width = 1, columns = 4, vectors = 2;
  using V = Scalar;
  static V load(const Scalar* p) { return *p; }
  static void store(Scalar* p, const V& v) { *p = v; }
};
/// Of complex numbers. The operators of std::complex take infinities into account, which here mean failure
/// anyway: products by their formula; an infinite or NaN pivot is found after the elimination.
template <class Real>
struct SingleLane<std::complex<Real>> {
  using Scalar = std::complex<Real>;
  static constexpr int width = 1, columns = 4, vectors = 2;
  struct V {
    Real re = 0, im = 0;
    friend V operator*(const V& a, const V& b) {
      return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
    }
    friend V operator*(const V& a, const Scalar& b) { return a * V{b.real(), b.imag()}; }
    void operator*=(const Scalar& b) { *this = *this * b; }
    void operator+=(const V& b) { re += b.re, im += b.im; }
    void operator-=(const V& b) { re -= b.re, im -= b.im; }
  };
  static V load(const Scalar* p) { return {p->real(), p->imag()}; }
  static void store(Scalar* p, const V& v) { *p = {v.re, v.im}; }
};

/// Memory of allocate_block(), at multiples of 64 as PanelShape asks for. The interface is that which
/// std::vector asks of an allocator.
template <class T>
struct AlignedAllocator {
  using value_type = T;

  AlignedAllocator() = default;
  template <class U>
  explicit AlignedAllocator(const AlignedAllocator<U>&) {}
  /// @throws std::bad_alloc
  static T* allocate(std::size_t count) { return static_cast<T*>(allocate_block(count * sizeof(T))); }
  static void deallocate(T* at, std::size_t count) { free_block(at, count * sizeof(T)); }
  bool operator==(const AlignedAllocator&) const = default;
};

/// The kernels of the processor for double; for other scalars the same loops, one number at a time.
template <class Scalar>
const PanelKernels<Scalar>& panel_kernels() {
  if constexpr (std::is_same_v<Scalar, double>) {
    return *available_panel_kernels().front();
  } else {
    static constexpr PanelKernels<Scalar> plain = panel_loops::kernels_of<SingleLane<Scalar>>("plain");
    return plain;
  }
}
}  // namespace detail

/// P A P^T = L D L^T of a symmetric A, shape (n, n), without pivoting: A may be indefinite, but its factors
/// are only as good as their pivots. Multifrontal: each panel takes up its entries of A and the updates of
/// its children, is eliminated as a dense matrix, and leaves its own update to its parent. Arithmetic so runs
/// over numbers that lie side by side, with one list of rows for all columns of a panel. The same input gives
/// the same bits on every processor and for any number of threads, which share large panels. After the first
/// factor() nothing but threads is allocated.
/// @source [liu1992multifrontal]
template <class Scalar>
class PanelFactor {
 public:
  using Index = int;
  using Matrix = Eigen::SparseMatrix<Scalar>;

  PanelFactor() = default;
  /// @param kernels  for tests of one instruction set; by default those of the processor
  explicit PanelFactor(const PanelKernels<Scalar>& kernels) : kernels_(&kernels) {}

  /// Takes the pattern of a compressed A, shape (n, n), which is symmetric and given in full; allocates.
  void analyse(const Matrix& A) {
    const auto n = static_cast<std::size_t>(A.cols());
    plan_ = PanelAnalysis({A.outerIndexPtr(), n + 1},
                          {A.innerIndexPtr(), static_cast<std::size_t>(A.nonZeros())});
    values_.clear();
    d_.resize(n);
    inverse_.resize(n);
    x_.resize(n);
    // The unknowns and the rows of one panel in solve(), padded.
    own_.resize(PanelShape::padded(plan_.widest));
    part_.resize(PanelShape::padded(plan_.tallest) + PanelShape::lanes);
  }

  /// Operations of one factorisation, sum over the columns j of L of (entries below and on the diagonal)^2,
  /// of which half are multiplications.
  [[nodiscard]] double work() const { return plan_.work; }

  /// P A P^T = L D L^T of the matrix that was analysed, or another one of its pattern. Both triangles are
  /// stored in A; those entries that are eliminated later than their column are read.
  /// @returns false when a pivot is zero or not finite; solve() must not be called then
  bool factor(const Matrix& A) {
    if (values_.empty()) {  // the first time, since iterations may come to need none
      values_.resize(plan_.values);
      updates_.resize(plan_.updates);
    }
    // Children before their parents: updates wait for the panel that takes them up.
    waiting_.clear();
    for (std::size_t p = 0; p < plan_.panels.size(); ++p)
      if (!eliminate(p, A.valuePtr())) return false;
    return true;
  }

  /// D, in the order of elimination, shape (n). Of a real A it has as many negative entries as A has
  /// negative eigenvalues.
  [[nodiscard]] std::span<const Scalar> pivots() const { return d_; }

  /// x = A^-1 x = P^T L^-T D^-1 L^-1 P x, shape (n). No allocation. Only after a factor() that returned
  /// true.
  template <class X>
  void solve(X& x) {
    const Index n = static_cast<Index>(plan_.to.size());
    // x_ = P x
    for (Index i = 0; i < n; ++i) x_[plan_.to[i]] = x[i];
    Scalar *const own = own_.data(), *const part = part_.data();
    // L^-1, panel by panel: own unknowns from the triangle T, then rows below from B.
    for (const Panel& panel : plan_.panels) {
      const auto [T, B] = parts(panel);
      Scalar* const unknowns = x_.data() + panel.first;
      const Index* const rows = plan_.rows.data() + panel.rows;
      load(unknowns, panel.width, own);
      kernels_->forward(T, B, panel.width, panel.height, own, part);
      std::copy_n(own, panel.width, unknowns);
      for (Index i = 0; i < panel.height; ++i) x_[rows[i]] += part[i];
    }
    // D^-1
    for (Index i = 0; i < n; ++i) x_[i] *= inverse_[i];
    // L^-T, from the last panel to the first.
    for (auto panel = plan_.panels.rbegin(); panel != plan_.panels.rend(); ++panel) {
      const auto [T, B] = parts(*panel);
      Scalar* const unknowns = x_.data() + panel->first;
      const Index* const rows = plan_.rows.data() + panel->rows;
      load(unknowns, panel->width, own);
      for (Index i = 0; i < panel->height; ++i) part[i] = x_[rows[i]];
      std::fill(part + panel->height, part + PanelShape::padded(panel->height), Scalar(0));
      kernels_->backward(T, B, panel->width, panel->height, own, part);
      std::copy_n(own, panel->width, unknowns);
    }
    for (Index i = 0; i < n; ++i) x[i] = x_[plan_.to[i]];
  }

 private:
  using Panel = PanelAnalysis::Panel;
  using Size = std::ptrdiff_t;
  /// Operations that are worth a thread: some 50 us.
  static constexpr std::size_t least_shared_work = 1'000'000;
  using AlignedVector = std::vector<Scalar, detail::AlignedAllocator<Scalar>>;
  /// Of a panel: triangle of its own unknowns, and the rows below.
  struct Parts {
    Scalar *T, *B;
  };
  Parts parts(const Panel& panel) {
    Scalar* const T = values_.data() + panel.values;
    return {T, T + PanelShape::padded(panel.width) * panel.width};
  }
  /// The update of a panel, lower triangle of shape (padded height, height).
  Scalar* update(const Panel& panel) { return updates_.data() + panel.update; }

  /// Copies `count` numbers and fills up to the padded length with zeros, which the kernels calculate with.
  static void load(const Scalar* from, Index count, Scalar* to) {
    std::copy_n(from, count, to);
    std::fill(to + count, to + PanelShape::padded(count), Scalar(0));
  }

  /// One step of the multifrontal method, for panel p [liu1992multifrontal]:
  ///   (T; B) = A + updates of the children,   L diag(d) L_T^T = (T; B),
  ///   U = rest of their updates - B diag(d) B^T,   B being that of L.
  /// The front of a panel is a matrix of its unknowns and rows; its columns of unknowns are the panel
  /// itself.
  /// @returns false where a pivot is zero or not finite
  bool eliminate(std::size_t p, const Scalar* A) {
    const Panel& panel = plan_.panels[p];
    const auto [T, B] = parts(panel);
    const Index w = panel.width, h = panel.height;
    // Of the triangle what stands above the diagonal is only calculated with, beside the rest.
    const auto tall = PanelShape::padded(w);
    for (std::ptrdiff_t j = 0; j < w; ++j)
      std::fill(T + j * tall + j / PanelShape::lanes * PanelShape::lanes, T + (j + 1) * tall, Scalar(0));
    std::fill(B, B + PanelShape::padded(h) * w, Scalar(0));
    // (T; B) = A and what the children leave of it.
    take_entries(p, A);
    // Children are the last panels that wait, since panels come in postorder.
    std::size_t first = waiting_.size();  // of its children
    while (first > 0 && plan_.panels[waiting_[first - 1]].parent == static_cast<Index>(p)) --first;
    for (std::size_t c = first; c < waiting_.size(); ++c) join_unknowns(plan_.panels[waiting_[c]], panel);
    Scalar* const d = d_.data() + panel.first;
    // L and d of the columns; U = -B D B^T goes to the parent.
    eliminate_columns(panel, d);
    // The kernels do not look at their pivots. After a failure the updates that still wait are of no use, and
    // the next factor() begins without them.
    for (Index i = 0; i < w; ++i) {
      if (!(std::abs(d[i]) > 0) || !std::isfinite(std::abs(d[i]))) return false;
      inverse_[panel.first + i] = Scalar(1) / d[i];
    }
    write_update(panel, d);
    for (std::size_t c = first; c < waiting_.size(); ++c) join_rows(plan_.panels[waiting_[c]], panel);
    waiting_.resize(first);
    if (h > 0) waiting_.push_back(static_cast<Index>(p));
    return true;
  }

  /// L and d of the columns of a panel, one block of them after the other. Rows below a block do not depend
  /// on one another.
  void eliminate_columns(const Panel& panel, Scalar* d) {
    const Parts own = parts(panel);
    Scalar *const T = own.T, *const B = own.B;  // no structured binding: Clang 14 captures none
    const Size w = panel.width, wide = PanelShape::padded(w), tall = PanelShape::padded(panel.height);
    for (Size s = 0; s < w; s += PanelShape::block) {
      kernels_->diagonal(T, w, s, d);
      // A row takes the products of the columns up to the end of the block.
      in_stretches(s + PanelShape::block, wide, PanelShape::block * (s + PanelShape::block),
                   [&](Size from, Size to) { kernels_->below(T, w, s, d, T + from, wide, to - from); });
    }
    in_stretches(0, tall, w * w, [&](Size from, Size to) {
      for (Size s = 0; s < w; s += PanelShape::block) kernels_->below(T, w, s, d, B + from, tall, to - from);
    });
  }

  /// U = -B diag(d) B^T of a panel, for its parent.
  void write_update(const Panel& panel, const Scalar* d) {
    const Scalar* const B = parts(panel).B;
    in_stretches(
        0, panel.height, Size{panel.width} * panel.height,
        [&](Size from, Size to) {
          kernels_->update(B, panel.width, panel.height, d, update(panel), from, to);
        },
        // The left columns of a lower triangle are the long ones: equal shares of the area.
        [](double share) { return 1 - std::sqrt(1 - share); });
  }

  /// work(begin, end) for all that is from `from` to `to`: in one piece, or where it is worth threads in
  /// stretches that begin at multiples of 8, which the kernels ask for. Numbers do not depend on where that
  /// is.
  /// @param operations  of one row or column
  /// @param place  where a share of the work, 0 to 1, ends between `from` and `to`, 0 to 1
  template <class Work, class Place = std::identity>
  static void in_stretches(Size from, Size to, Size operations, const Work& work, const Place& place = {}) {
    if (from >= to) return;
    const auto worth =
        static_cast<std::size_t>(to - from) * static_cast<std::size_t>(operations) / least_shared_work;
    const std::size_t workers = worth > 1 ? std::min(threads(), worth) : 1;
    if (workers == 1) return work(from, to);
    // Two for each thread: one that is held up leaves the rest to the others.
    const std::size_t count = 2 * workers;
    const auto edge = [&](std::size_t i) {
      if (i == count) return to;
      const double share = place(static_cast<double>(i) / static_cast<double>(count));
      return from + static_cast<Size>(static_cast<double>(to - from) * share) / PanelShape::lanes *
                        PanelShape::lanes;
    };
    parallel_for(count, [&](std::size_t i, std::size_t) {
      if (edge(i) < edge(i + 1)) work(edge(i), edge(i + 1));
    });
  }

  /// Copies the entries of A that belong to a panel, in runs that are contiguous on both sides.
  void take_entries(std::size_t p, const Scalar* A) {
    const auto& all = plan_.entries;
    const std::size_t end = p + 1 < plan_.panels.size() ? plan_.panels[p + 1].entries : all.size();
    Scalar* const values = values_.data();
    for (std::size_t r = plan_.panels[p].entries; r < end; ++r) {
      const Scalar* const from = A + all[r].from;
      Scalar* const to = values + all[r].to;
      if (all[r].length == 3) {  // a point of a body
        to[0] = from[0];
        to[1] = from[1];
        to[2] = from[2];
      } else {
        std::copy_n(from, all[r].length, to);
      }
    }
  }

  /// Adds the columns of a child's update that are unknowns of its parent to the panel of that: to T the
  /// rows that are unknowns of the parent too, to B the others. Runs of rows before joins[1] of the child are
  /// of the first kind, those from there to joins[2] of the second. The lower triangle is enough.
  void join_unknowns(const Panel& child, const Panel& parent) {
    const auto [T, B] = parts(parent);
    const auto* const joins = plan_.joins.data();
    for (std::size_t c = child.joins[0]; c < child.joins[1]; ++c)
      // Column k of the run c: the lower triangle only, from its diagonal on.
      for (Index k = 0; k < joins[c].length; ++k) {
        const auto column = static_cast<std::ptrdiff_t>(joins[c].to) + k;
        const Scalar* const U = update(child) + PanelShape::padded(child.height) * (joins[c].from + k);
        Scalar* const t = T + PanelShape::padded(parent.width) * column;
        Scalar* const b = B + PanelShape::padded(parent.height) * column;
        add(joins[c].length - k, U + joins[c].from + k, t + column);
        for (std::size_t r = c + 1; r < child.joins[1]; ++r)
          add(joins[r].length, U + joins[r].from, t + joins[r].to);
        for (std::size_t r = child.joins[1]; r < child.joins[2]; ++r)
          add(joins[r].length, U + joins[r].from, b + joins[r].to);
      }
  }

  /// Adds the other columns of a child's update, whose rows are rows of the parent, to the update of its
  /// parent. Called after the kernel has written that, which overwrites it.
  void join_rows(const Panel& child, const Panel& parent) {
    const auto* const joins = plan_.joins.data();
    for (std::size_t c = child.joins[1]; c < child.joins[2]; ++c)
      for (Index k = 0; k < joins[c].length; ++k) {
        const auto column = static_cast<std::ptrdiff_t>(joins[c].to) + k;
        const Scalar* const U = update(child) + PanelShape::padded(child.height) * (joins[c].from + k);
        Scalar* const u = update(parent) + PanelShape::padded(parent.height) * column;
        add(joins[c].length - k, U + joins[c].from + k, u + column);
        for (std::size_t r = c + 1; r < child.joins[2]; ++r)
          add(joins[r].length, U + joins[r].from, u + joins[r].to);
      }
  }

  /// to += from, `count` numbers side by side.
  static void add(Index count, const Scalar* from, Scalar* to) {
    for (Index i = 0; i < count; ++i) to[i] += from[i];
  }

  const PanelKernels<Scalar>* kernels_ = &detail::panel_kernels<Scalar>();
  PanelAnalysis plan_;
  /// Panels, updates that wait, and the vectors of one panel in solve(); all begin at multiples of 64 bytes.
  AlignedVector values_, updates_, own_, part_;
  /// D, its reciprocals and the unknowns, in the order of elimination, shape (n).
  std::vector<Scalar> d_, inverse_, x_;
  std::vector<Index> waiting_;  ///< panels whose updates have not been taken up
};

}  // namespace hmax
