/// A reaction with diffusion in one dimension, by the method of lines.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "problems/test_set/common.hpp"

namespace hmax {

struct BrusselatorParameters {
  double n = 40;        ///< inner grid points [1]
  double A = 1;         ///< feed of u; also u at both ends [1]
  double B = 3;         ///< rate of u -> v; also v at both ends [1]
  double alpha = 0.02;  ///< diffusion [1]
  static constexpr ParameterNames<BrusselatorParameters, 4> names{{{"n", &BrusselatorParameters::n},
                                                                   {"A", &BrusselatorParameters::A},
                                                                   {"B", &BrusselatorParameters::B},
                                                                   {"alpha", &BrusselatorParameters::alpha}}};
};

/// u_t = A + u^2 v - (B + 1) u + alpha u_xx,   v_t = B u - u^2 v + alpha v_xx   on 0 < x < 1, without units,
/// with u = A, v = B at both ends and u = 1 + sin(2 pi x), v = 3 at the start; central differences on
/// x_i = i / (n + 1). y = (u_1, v_1, u_2, v_2, ..., u_n, v_n), shape (2 n): a band of two above and below the
/// diagonal. The stiff part of the split is the diffusion, whose eigenvalues are
///   -4 alpha (n + 1)^2 sin^2(j pi / (2 (n + 1))),   j = 1 ... n
/// @source  [hairer1996solving, IV.10]; the end point was computed in 113 bits
template <class Real>
class Brusselator {
 public:
  using State = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  using Jacobian = Eigen::SparseMatrix<Real>;
  using Parameters = BrusselatorParameters;
  static constexpr std::string_view id = "brusselator", source = "hairer1996solving",
                                    note = "a reaction with diffusion in one dimension, n grid points";
  static constexpr bool autonomous = true, stiff = true;
  static constexpr double t_end = 10;
  /// u_20 and v_20 at t_end for the default parameters, and their relative error; a sine of y0() that is
  /// rounded otherwise may move them by as much.
  static constexpr std::array<long double, 2> end_point_middle{0.43006072969389687570L,
                                                               3.6881458284308198749L};
  static constexpr double end_point_error = 1e-16;

  /// @throws std::invalid_argument  unless n is a whole number and alpha positive
  explicit Brusselator(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)),
        n_(detail::count_of(parameters.n, "n", id)),
        A_(static_cast<Real>(parameters.A)),
        B_(static_cast<Real>(parameters.B)),
        d_(static_cast<Real>(parameters.alpha) * static_cast<Real>(n_ + 1) * static_cast<Real>(n_ + 1)) {
    detail::require_positive(parameters.alpha, "alpha", id);
  }

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] Eigen::Index dim() const { return 2 * n_; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::nonlinear; }
  [[nodiscard]] std::vector<std::string> states() const {
    std::vector<std::string> names;
    for (Eigen::Index i = 1; i <= n_; ++i) {
      names.push_back("u" + std::to_string(i));
      names.push_back("v" + std::to_string(i));
    }
    return names;
  }
  [[nodiscard]] State y0() const {
    State y(dim());
    for (Eigen::Index i = 0; i < n_; ++i) {
      const double x = static_cast<double>(i + 1) / static_cast<double>(n_ + 1);
      y[2 * i] = static_cast<Real>(1 + std::sin(2 * std::numbers::pi * x));
      y[2 * i + 1] = Real(3);
    }
    return y;
  }

  void rhs(Real t, const State& y, State& dydt) const {
    rhs_stiff(t, y, dydt);
    each_node(y, [&](Eigen::Index i, Real du, Real dv) {
      dydt[i] += du;
      dydt[i + 1] += dv;
    });
  }
  void jacobian(Real /*t*/, const State& y, Jacobian& J) const {
    detail::write_sparse(J, dim(), [&](const auto& emit) { entries(y, Real(1), emit); });
  }

  static constexpr bool linear_stiff_part = true;
  /// The diffusion with its boundary values.
  void rhs_stiff(Real /*t*/, const State& y, State& dydt) const {
    const Eigen::Index size = dim();
    for (Eigen::Index i = 0; i < size; ++i) {
      const Real end = i % 2 == 0 ? A_ : B_;
      const Real left = i >= 2 ? y[i - 2] : end, right = i + 2 < size ? y[i + 2] : end;
      dydt[i] = d_ * ((left - y[i]) + (right - y[i]));
    }
  }
  void jacobian_stiff(Real /*t*/, const State& y, Jacobian& J) const {
    detail::write_sparse(J, dim(), [&](const auto& emit) { entries(y, Real(0), emit); });
  }
  /// The reaction at each grid point.
  void rhs_nonstiff(Real /*t*/, const State& y, State& dydt) const {
    each_node(y, [&](Eigen::Index i, Real du, Real dv) {
      dydt[i] = du;
      dydt[i + 1] = dv;
    });
  }

  /// |J|_2 <= |diffusion|_2 + the largest Frobenius norm of the reaction's 2 x 2 blocks: the diffusion is
  /// symmetric with eigenvalues in (-4 alpha (n + 1)^2, 0).
  [[nodiscard]] Real spectral_radius(Real /*t*/, const State& y) const {
    using std::sqrt;
    Real largest(0);
    for (Eigen::Index i = 0; i < dim(); i += 2) largest = std::max(largest, reaction(y, i).squaredNorm());
    return Real(4) * d_ + sqrt(largest);
  }

 private:
  using Block = Eigen::Matrix<Real, 2, 2>;

  /// visit(i, reaction of u, reaction of v) for each grid point, whose u is y[i].
  template <class Visit>
  void each_node(const State& y, const Visit& visit) const {
    for (Eigen::Index i = 0; i < dim(); i += 2) {
      const Real u = y[i], uuv = u * u * y[i + 1];
      visit(i, A_ + uuv - (B_ + Real(1)) * u, B_ * u - uuv);
    }
  }
  /// d(reaction of u, v) / d(u, v) at the grid point whose u is y[i].
  [[nodiscard]] Block reaction(const State& y, Eigen::Index i) const {
    const Real u = y[i], twice = Real(2) * u * y[i + 1];
    Block block;
    block << twice - (B_ + Real(1)), u * u, B_ - twice, -u * u;
    return block;
  }
  /// All entries of diffusion + with_reaction * reaction in the order write_sparse() asks for. Both Jacobians
  /// share one pattern, in which that of the diffusion alone has zeros.
  template <class Emit>
  void entries(const State& y, Real with_reaction, const Emit& emit) const {
    const Eigen::Index size = dim();
    for (Eigen::Index i = 0; i < size; i += 2) {
      const Block block = with_reaction * reaction(y, i);
      for (Eigen::Index c = 0; c < 2; ++c) {
        const Eigen::Index column = i + c;
        if (column >= 2) emit(column - 2, column, d_);
        for (Eigen::Index row = 0; row < 2; ++row)
          emit(i + row, column, row == c ? block(row, c) - Real(2) * d_ : block(row, c));
        if (column + 2 < size) emit(column + 2, column, d_);
      }
    }
  }

  Parameters parameters_;
  Eigen::Index n_;
  Real A_, B_, d_;  // d_ = alpha (n + 1)^2
};

}  // namespace hmax
