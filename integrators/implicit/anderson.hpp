/// Anderson's acceleration of a fixed-point iteration.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "core/dense_solvers.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// w <- w + d - (W + D) c with c that makes |d - D c| least, where the columns of W and D are the last
/// changes of w and of its correction d = G(w) - w. On a linear G that is GMRES: iterations that diverge
/// slowly converge too.
/// @tparam StateT  Eigen column vector of a real scalar, shape (n)
/// @tparam parts   vectors that are iterated together
/// @source [walker2011anderson]
template <class StateT, std::size_t parts>
class AndersonMixing {
 public:
  using State = StateT;
  using Real = real_of<State>;
  using Vectors = std::array<State, parts>;
  static constexpr Eigen::Index most = 25;  ///< changes that are remembered

  /// Forgets all changes, as where G has become another map.
  void forget() { known_ = 0, has_last_ = false; }

  /// The next iterate, in the place of w. @param d  the correction of w
  void step(Vectors& w, const Vectors& d) {
    const Eigen::Index n = w[0].size(), size = static_cast<Eigen::Index>(parts) * n;
    if (W_.rows() != size) {
      W_.resize(size, most);
      D_.resize(size, most);
      known_ = 0;
      has_last_ = false;
    }
    Column now_w(size), now_d(size);
    for (std::size_t i = 0; i < parts; ++i) {
      now_w.segment(static_cast<Eigen::Index>(i) * n, n) = w[i];
      now_d.segment(static_cast<Eigen::Index>(i) * n, n) = d[i];
    }
    if (has_last_) {
      const Eigen::Index slot = known_++ % most;
      W_.col(slot) = now_w - last_w_;
      D_.col(slot) = now_d - last_d_;
    }
    last_w_ = now_w;
    last_d_ = now_d;
    has_last_ = true;
    now_w += now_d;
    if (const Eigen::Index used = std::min(known_, most); used > 0) {
      // Digits of c are digits of the rate alone: those of double are enough.
      const Column c =
          minimum_norm_solution(D_.leftCols(used).template cast<double>(), now_d.template cast<double>())
              .template cast<Real>();
      now_w -= (W_.leftCols(used) + D_.leftCols(used)) * c;
    }
    for (std::size_t i = 0; i < parts; ++i) w[i] = now_w.segment(static_cast<Eigen::Index>(i) * n, n);
  }

 private:
  using Column = Eigen::Vector<Real, Eigen::Dynamic>;
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> W_, D_;  ///< shape (parts n, most)
  Column last_w_, last_d_;
  Eigen::Index known_ = 0;
  bool has_last_ = false;
};

}  // namespace hmax
