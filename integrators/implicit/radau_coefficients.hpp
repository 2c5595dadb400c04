/// Radau IIA of order 5 as constexpr data, in the form that splits its equations into a real and a complex
/// one.
#pragma once

#include <array>
#include <cstddef>

#include "integrators/explicit/tableau.hpp"

namespace hmax::radau {

/// A row of a 3 x 3 matrix, and a matrix by rows.
using Row = std::array<long double, 3>;
using Matrix3 = std::array<Row, 3>;

namespace detail {
/// sqrt(x), x > 0, by Newton's method: std::sqrt is not constexpr.
constexpr long double square_root(long double x) {
  long double root = x > 1 ? x : 1;
  // Decreases to the root from above, quadratically at the end.
  for (int k = 0; k < 100; ++k) root = (root + x / root) / 2;
  return root;
}

/// The real root of w^3 - 9 w^2 + 36 w - 60, the characteristic polynomial of A^-1, by Newton's method.
constexpr long double real_eigenvalue() {
  long double w = 3.6L;
  for (int k = 0; k < 20; ++k) w -= (((w - 9) * w + 36) * w - 60) / ((3 * w - 18) * w + 36);
  return w;
}

/// The inverse by cofactors: out_ij = cofactor_ji / det.
constexpr Matrix3 inverse(const Matrix3& m) {
  Matrix3 out{};
  long double determinant = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t r1 = (j + 1) % 3, r2 = (j + 2) % 3, c1 = (i + 1) % 3, c2 = (i + 2) % 3;
      out[i][j] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
    }
  }
  // det m, along its first row.
  for (std::size_t j = 0; j < 3; ++j) determinant += m[0][j] * out[j][0];
  for (Row& row : out)
    for (long double& x : row) x /= determinant;
  return out;
}
}  // namespace detail

/// sqrt(6): every coefficient of the tableau is a + b sqrt(6) with rational a and b.
inline constexpr long double root6 = detail::square_root(6);

/// Collocation at the three Radau points, the zeros of d^2/dx^2 (x^2 (x - 1)^3). Stiffly accurate: b is the
/// last row of A. [hairer1996solving, IV.5 table 5.6]
inline constexpr ButcherTableau<3> tableau{
    .a = {{{(88 - 7 * root6) / 360, (296 - 169 * root6) / 1800, (-2 + 3 * root6) / 225},
           {(296 + 169 * root6) / 1800, (88 + 7 * root6) / 360, (-2 - 3 * root6) / 225},
           {(16 - root6) / 36, (16 + root6) / 36, 1 / 9.0L}}},
    .b = {(16 - root6) / 36, (16 + root6) / 36, 1 / 9.0L},
    .b_err = {},
    .c = {(4 - root6) / 10, (4 + root6) / 10, 1}};

/// The eigenvalues of A^-1: gamma and alpha +- i beta. [hairer1996solving, IV.8]
///   gamma + 2 alpha = 9,   gamma (alpha^2 + beta^2) = 60
inline constexpr long double gamma = detail::real_eigenvalue();
inline constexpr long double alpha = (9 - gamma) / 2;
inline constexpr long double beta = detail::square_root(60 / gamma - alpha * alpha);

namespace detail {
/// A complex number for constants: std::complex<long double> of libstdc++ is not constexpr for clang.
struct ComplexConstant {
  long double re = 0, im = 0;

  /// Real numbers convert, so that eigenvector() is written once.
  constexpr ComplexConstant(long double real, long double imaginary = 0) : re(real), im(imaginary) {}
  friend constexpr ComplexConstant operator-(ComplexConstant a) { return {-a.re, -a.im}; }
  friend constexpr ComplexConstant operator-(ComplexConstant a, ComplexConstant b) {
    return {a.re - b.re, a.im - b.im};
  }
  friend constexpr ComplexConstant operator*(ComplexConstant a, ComplexConstant b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  friend constexpr ComplexConstant operator/(ComplexConstant a, ComplexConstant b) {
    const long double square = b.re * b.re + b.im * b.im;
    return {(a.re * b.re + a.im * b.im) / square, (a.im * b.re - a.re * b.im) / square};
  }
};

/// v = (v_1, v_2, 1) with A^-1 v = w v, from the first two rows of (I - w A) v = 0.
template <class Number>
constexpr std::array<Number, 2> eigenvector(Number w) {
  const auto& a = tableau.a;
  // (I - w A) (v_1, v_2) = w (a_13, a_23) in the first two rows, by Cramer's rule.
  const Number m00 = Number(1) - w * a[0][0], m01 = -w * a[0][1], m10 = -w * a[1][0];
  const Number m11 = Number(1) - w * a[1][1], b0 = w * a[0][2], b1 = w * a[1][2];
  const Number determinant = m00 * m11 - m01 * m10;
  return {(b0 * m11 - m01 * b1) / determinant, (m00 * b1 - m10 * b0) / determinant};
}
/// Columns: the eigenvector of gamma, then real and imaginary part of that of alpha - i beta.
constexpr Matrix3 eigenvectors() {
  const auto v = eigenvector<long double>(gamma);
  const auto u = eigenvector<ComplexConstant>({alpha, -beta});
  return {{{v[0], u[0].re, u[0].im}, {v[1], u[1].re, u[1].im}, {1, 1, 0}}};
}
}  // namespace detail

/// T with T^-1 A^-1 T = ((gamma, 0, 0), (0, alpha, -beta), (0, beta, alpha)), and its inverse, shape (3,
/// 3). In w = T^-1 z the 3 n equations of a step are n real and n complex ones.
inline constexpr Matrix3 T = detail::eigenvectors(), T_inverse = detail::inverse(T);

/// y_hat - y_new = h / gamma f(t, y) + e_1 z_1 + e_2 z_2 + e_3 z_3, the distance to a result of order 3.
/// [hairer1996solving, IV.8 (8.18)]
inline constexpr Row e{(-13 - 7 * root6) / (3 * gamma), (-13 + 7 * root6) / (3 * gamma), -1 / (3 * gamma)};

/// Whether A T = T blocks^-1 and T T_inverse = 1, each entry within 1e-17.
constexpr bool splits_the_equations(const ButcherTableau<3>& method, const Matrix3& vectors,
                                    const Matrix3& inverse, long double real, long double re,
                                    long double im) {
  // T^-1 A^-1 T
  const Matrix3 blocks{{{real, 0, 0}, {0, re, -im}, {0, im, re}}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      long double defect = vectors[i][j], identity = i == j ? -1 : 0;  // of A T blocks = T
      for (std::size_t k = 0; k < 3; ++k) {
        identity += vectors[i][k] * inverse[k][j];
        for (std::size_t l = 0; l < 3; ++l) defect -= method.a[i][k] * vectors[k][l] * blocks[l][j];
      }
      if (hmax::detail::magnitude(defect) > 1e-17L || hmax::detail::magnitude(identity) > 1e-17L)
        return false;
    }
  return true;
}

/// The quadrature with nodes 0, c_1, c_2, c_3 and weights 1 / gamma, e A gives zero for 1, t and t^2,
/// within 1e-17: the difference of two formulas of order 3. It is the error estimate where f depends on t
/// alone, z = h A f.
constexpr bool error_is_of_order_four(const ButcherTableau<3>& method, const Row& weights, long double real) {
  for (int power = 0; power < 3; ++power) {
    long double sum = power == 0 ? 1 / real : 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        long double term = weights[i] * method.a[i][j];
        for (int k = 0; k < power; ++k) term *= method.c[j];
        sum += term;
      }
    if (hmax::detail::magnitude(sum) > 1e-17L) return false;
  }
  return true;
}

/// The tableau is of order 5 and not 6, its rows sum to c, its last row is b, and it has no embedded
/// method.
constexpr bool is_proved(const ButcherTableau<3>& method) {
  return order_of(method) == 5 && rows_are_consistent(method) && is_stiffly_accurate(method) &&
         !has_error_estimate(method);
}
static_assert(is_proved(tableau));
static_assert(splits_the_equations(tableau, T, T_inverse, gamma, alpha, beta));
static_assert(error_is_of_order_four(tableau, e, gamma));

}  // namespace hmax::radau
