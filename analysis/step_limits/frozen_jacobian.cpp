#include "analysis/step_limits/frozen_jacobian.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/numbers.hpp"

namespace hmax {

namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;

/// step_matrix for matrices of any kind; those of a spring live on the stack.
template <class Matrix>
Matrix step_of(const LinearlyImplicitMethod& method, const Matrix& hA, const Matrix& hA0) {
  const std::size_t s = method.b.size();
  const Matrix I = Matrix::Identity(hA.rows(), hA.cols());
  std::vector<Matrix> K(s);
  Matrix S = I, inverse = I, argument = I, older = I;
  for (std::size_t i = 0; i < s; ++i) {
    argument = I;
    older.setZero();
    for (std::size_t j = 0; j < i; ++j) {
      argument += method.alpha[i * s + j] * K[j];
      older += method.gamma[i * s + j] * K[j];
    }
    // One gamma serves all stages of the methods of the house.
    if (i == 0 || method.gamma[i * s + i] != method.gamma[(i - 1) * (s + 1)])
      inverse = (I - method.gamma[i * s + i] * hA0).inverse();
    K[i] = inverse * (hA * argument + hA0 * older);
    S += method.b[i] * K[i];
  }
  return S;
}

/// (x, v / omega0) of an undamped spring, times h: stiffness `ratio` k0, x0 = omega0 h.
Matrix2d spring(double ratio, double x0) {
  Matrix2d A;
  A << 0, x0, -ratio * x0, 0;
  return A;
}

/// The exact flow of the spring over a step.
Matrix2d flow(double ratio, double x0) {
  const double root = std::sqrt(ratio), angle = root * x0;
  Matrix2d F;
  F << std::cos(angle), std::sin(angle) / root, -root * std::sin(angle), std::cos(angle);
  return F;
}

/// Whether both multipliers of a real map of the plane are at most one but for rounding; decided by trace and
/// determinant, which a double multiplier does not blur.
bool is_stable(const Matrix2d& S) {
  constexpr double rounding = 1e-11;
  const double trace = S.trace(), determinant = S.determinant();
  return std::abs(determinant) <= 1 + rounding && std::abs(trace) <= 1 + determinant + rounding;
}

double radius_of(const Matrix2d& S) {
  const double half = S.trace() / 2, gap = half * half - S.determinant();
  return gap < 0 ? std::sqrt(std::max(S.determinant(), 0.0)) : std::abs(half) + std::sqrt(gap);
}

/// A twentieth of a radian a step: growth with the fourth power of it is still seen.
double small_step(double ratio) { return 0.05 / std::sqrt(std::max(ratio, 1.0)); }

/// The first exit from the origin by strides and bisection.
/// @param least  what is unstable there is so at any smaller step
template <class Stable>
double first_exit_of(double least, const Stable& stable) {
  constexpr double most = 1e6, stride = 1.005;
  if (!stable(least)) return 0;
  for (double low = least; low < most; low *= stride) {
    double high = low * stride;
    if (stable(high)) continue;
    double inside = low;
    while (high - inside > 1e-14 * high) {
      const double middle = inside + (high - inside) / 2;
      if (middle <= inside || middle >= high) break;
      (stable(middle) ? inside : high) = middle;
    }
    return inside;
  }
  return infinity;
}

/// The ends of the stretch around 1 on which `every_step_stable` holds.
template <class Stable>
ToleratedRatios ratios_where(const Stable& every_step_stable) {
  const auto end = [&](double factor, double farthest) {
    double inside = 1, outside = 1;
    while (true) {
      outside = inside * factor;
      if (factor > 1 ? outside > farthest : outside < farthest) return factor > 1 ? infinity : 0.0;
      if (!every_step_stable(outside)) break;
      inside = outside;
    }
    while (std::abs(outside - inside) > 1e-12 * inside) {
      const double middle = (inside + outside) / 2;
      (every_step_stable(middle) ? inside : outside) = middle;
    }
    // What begins at 1 itself is seen from there on where it has grown out of rounding.
    return std::abs(inside - 1) < 1e-3 ? 1 : inside;
  };
  return {end(1 / 1.05, 1e-6), end(1.05, 1e6)};
}

}  // namespace

MatrixXd step_matrix(const LinearlyImplicitMethod& method, const MatrixXd& hA, const MatrixXd& hA0) {
  return step_of<MatrixXd>(method, hA, hA0);
}

ToleratedRatios tolerated_decay(const Amplification& amplification) {
  return ratios_where([&](double ratio) {
    Eigenmode mode(Complex(-ratio, 0));
    mode.frozen = -1;
    return std::isinf(first_exit(amplification.of_eigenmode(mode)));
  });
}

double frozen_spring_exit(const LinearlyImplicitMethod& method, double ratio) {
  return first_exit_of(small_step(ratio), [&](double x0) {
    return is_stable(step_of(method, spring(ratio, x0), spring(1, x0)));
  });
}

ToleratedRatios tolerated_stiffness(const LinearlyImplicitMethod& method) {
  return ratios_where([&](double ratio) { return std::isinf(frozen_spring_exit(method, ratio)); });
}

ToleratedRatios tolerated_stiffness(const LinearlyImplicitMethod& method, double omega0_h) {
  return ratios_where([&](double ratio) { return frozen_spring_exit(method, ratio) >= omega0_h; });
}

double stiffening_exit(const LinearlyImplicitMethod& method, double ratio, int steps) {
  const auto over_period = [&](const auto& step) {
    Matrix2d period = Matrix2d::Identity();
    for (int j = 0; j < steps; ++j) period = step(1 + (ratio - 1) * j / steps) * period;
    return period;
  };
  double resonance = 1;
  for (double x0 = 0.01; x0 < 10; x0 += 0.01)
    resonance = std::max(resonance, radius_of(over_period([&](double k) { return flow(k, x0); })));
  return first_exit_of(small_step(ratio), [&](double x0) {
    const Matrix2d period =
        over_period([&](double k) -> Matrix2d { return step_of(method, spring(k, x0), spring(1, x0)); });
    return is_stable(period) || radius_of(period) <= resonance;
  });
}

}  // namespace hmax
