/// The stages of stabilised methods: coefficients for any number of them, and what a step makes of a stage;
/// one source for the processor and for devices.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "core/instructions/device_code.hpp"

namespace hmax {

/// Shifted Chebyshev polynomials, damped by eps = 2/13 [sommeijer1998rkc].
/// A family of polynomials P_0 = 1, P_1 = x, P_j = alpha_j x P_{j-1} - beta_j P_{j-2} makes a method of order
/// two: it tells alpha_j and beta_j, the point w0 around which it is expanded, how far along the negative
/// real axis s stages are stable, and which is the smallest number of stages that reaches so far.
struct Rkc2 {
  static constexpr std::string_view id = "rkc_2", source = "sommeijer1998rkc";
  static constexpr double damping = 2.0 / 13;  ///< eps of w0 = 1 + eps / s^2

  /// T_j(x) = 2 x T_{j-1}(x) - T_{j-2}(x).
  template <class Real>
  static Real alpha(int) {
    return Real(2);
  }
  template <class Real>
  static Real beta(int) {
    return Real(1);
  }
  /// w0 = 1 + eps / s^2, eps = 2/13: |R| stays below 1 inside of the interval.
  template <class Real>
  static Real w0(int s) {
    return 1 + Real(2) / (13 * static_cast<Real>(s) * static_cast<Real>(s));
  }
  /// Where stability ends, as a bound of h times the spectral radius:
  /// beta(s) = (2/3) (s^2 - 1) (1 - (2/15) eps), a little less than the first point where |R| = 1.
  template <class Real>
  static Real reach(int s) {
    return slope<Real>() * (static_cast<Real>(s) * static_cast<Real>(s) - 1);
  }
  /// The smallest s >= 2 with beta(s) >= x.
  template <class Real>
  static int stages(Real x) {
    return std::max(2, static_cast<int>(std::ceil(std::sqrt(1 + x / slope<Real>()))));
  }

 private:
  /// beta(s) / (s^2 - 1).
  template <class Real>
  static constexpr Real slope() {
    return (Real(2) / 3) * (1 - (Real(2) / 15) * (Real(2) / 13));
  }
};

/// Legendre polynomials, which need no damping; s is odd, since even ones are not damped at the end of their
/// reach, (s^2 + s - 2) / 2 [meyer2014stabilized].
struct Rkl2 {
  static constexpr std::string_view id = "rkl_2", source = "meyer2014stabilized";

  /// j P_j(x) = (2 j - 1) x P_{j-1}(x) - (j - 1) P_{j-2}(x), as alpha_j and beta_j.
  template <class Real>
  static Real alpha(int j) {
    return static_cast<Real>(2 * j - 1) / static_cast<Real>(j);
  }
  template <class Real>
  static Real beta(int j) {
    return static_cast<Real>(j - 1) / static_cast<Real>(j);
  }
  template <class Real>
  static Real w0(int) {
    return Real(1);
  }
  /// (s^2 + s - 2) / 2: with many stages a quarter less than the reach of RKC2.
  template <class Real>
  static Real reach(int s) {
    return (static_cast<Real>(s) * static_cast<Real>(s) + static_cast<Real>(s) - 2) / 2;
  }
  /// The smallest odd s >= 3 with reach(s) >= x.
  template <class Real>
  static int stages(Real x) {
    const int s = std::max(3, static_cast<int>(std::ceil((std::sqrt(9 + 8 * x) - 1) / 2)));
    return s + (s % 2 == 0 ? 1 : 0);
  }
};

/// The coefficients of the s stages of a step of unit length.
/// With w0, w1 = P_s'(w0) / P_s''(w0), b_j = P_j''(w0) / P_j'(w0)^2, b_0 = b_1 = b_2, a_j = 1 - b_j P_j(w0):
///   mu_j = alpha_j w0 b_j / b_{j-1},  nu_j = -beta_j b_j / b_{j-2},  mu~_j = alpha_j w1 b_j / b_{j-1},
///   gamma~_j = -a_{j-1} mu~_j,  R_j(z) = a_j + b_j P_j(w0 + w1 z).
template <class Real>
struct StabilizedStage {
  Real mu, nu, rest;   ///< of Y_{j-1}, Y_{j-2} and y: mu + nu + rest = 1
  Real mu_f, gamma_f;  ///< of h f(Y_{j-1}) and h f(y)
  Real node;           ///< c_{j-1}: f(Y_{j-1}) is taken at t + c_{j-1} h
  bool operator==(const StabilizedStage&) const = default;

  /// Of a step of length h.
  [[nodiscard]] StabilizedStage times(Real h) const { return {mu, nu, rest, h * mu_f, h * gamma_f, node}; }
  /// Y_j of Y_{j-1}, Y_{j-2}, y, f(Y_{j-1}) and f(y): numbers, or vectors and then an expression.
  template <class Number>
  [[nodiscard]] HMAX_DEVICE auto of(const Number& newer, const Number& older, const Number& y,
                                    const Number& slope, const Number& first_slope) const {
    return (mu * newer + nu * older + rest * y) + (mu_f * slope + gamma_f * first_slope);
  }
};

/// err = 0.8 (y - y_new) + 0.4 h (f(y) + f(y_new)).
template <class Real, class Number>
HMAX_DEVICE inline Number stabilized_error(Real h, const Number& y, const Number& y_new,
                                           const Number& first_slope, const Number& end_slope) {
  return Real(0.8) * (y - y_new) + (Real(0.4) * h) * (first_slope + end_slope);
}

/// Rounding enters a step multiplied by some 10 s^2 [sommeijer1998rkc]: with more stages than this half of
/// the digits would be lost: 10 s^2 eps = sqrt(eps), 2590 stages of double. A step that needs more is as
/// unstable as that of any explicit method.
template <class Real>
int most_stabilized_stages() {
  return static_cast<int>(std::pow(std::numeric_limits<Real>::epsilon(), Real(-0.25)) / std::sqrt(Real(10)));
}

/// The longest step that is stable with so many stages, in the units of t; infinite where the spectral radius
/// is zero.
template <class Polynomials, class Real>
Real longest_stabilized_step(Real radius) {
  return radius > 0 ? Polynomials::template reach<Real>(most_stabilized_stages<Real>()) / radius
                    : std::numeric_limits<Real>::infinity();
}

/// Writes the stages j = 1 .. s; that of j = 1 has only mu_f.
/// @param s       number of stages, at least 2
/// @param stages  resized to s; entry j - 1 belongs to Y_j
template <class Polynomials, class Real>
void make_stages(int s, std::vector<StabilizedStage<Real>>& stages) {
  // P_j, P_j', P_j'' at w0 for the last three j.
  struct Values {
    Real p, d, d2;
  };
  const Real w0 = Polynomials::template w0<Real>(s);
  // P_j = alpha w0 P_{j-1} - beta P_{j-2} and its derivatives with respect to w0.
  const auto next = [w0](int j, const Values& one, const Values& two) {
    const Real alpha = Polynomials::template alpha<Real>(j), beta = Polynomials::template beta<Real>(j);
    return Values{alpha * w0 * one.p - beta * two.p, alpha * (one.p + w0 * one.d) - beta * two.d,
                  alpha * (2 * one.d + w0 * one.d2) - beta * two.d2};
  };
  // P_0 = 1 and P_1 = x with their derivatives at w0.
  const Values first{1, 0, 0}, second{w0, 1, 0};
  Values two = first, one = second;
  for (int j = 2; j <= s; ++j) two = std::exchange(one, next(j, one, two));
  // w1 = P_s'(w0) / P_s''(w0)
  const Real w1 = one.d / one.d2;

  stages.resize(static_cast<std::size_t>(s));
  two = first;
  one = second;
  // b_0 = b_1 = b_2 = P_2'' / P_2'^2
  const Values third = next(2, one, two);
  Real b_two = third.d2 / (third.d * third.d), b_one = b_two;
  // Y_1 = y + h mu~_1 f(y) with mu~_1 = b_1 w1.
  stages[0] = {0, 0, 1, b_one * w1, 0, 0};
  // c_0 = 0, c_1 = mu~_1
  Real c_two{0}, c_one = stages[0].mu_f;
  for (int j = 2; j <= s; ++j) {
    const Values now = next(j, one, two);
    const Real b = now.d2 / (now.d * now.d), a_one = 1 - b_one * one.p;
    const Real ratio = Polynomials::template alpha<Real>(j) * b / b_one;
    const Real mu = ratio * w0, nu = -Polynomials::template beta<Real>(j) * b / b_two, mu_f = ratio * w1;
    stages[static_cast<std::size_t>(j - 1)] = {mu, nu, 1 - mu - nu, mu_f, -a_one * mu_f, c_one};
    // c_j = mu_j c_{j-1} + nu_j c_{j-2} + mu~_j + gamma~_j
    const Real c = mu * c_one + nu * c_two + mu_f * (1 - a_one);
    c_two = std::exchange(c_one, c);
    b_two = std::exchange(b_one, b);
    two = std::exchange(one, now);
  }
}

/// Makes the stages of a step of length h, computed again only when their number changes: reach(s) >=
/// |h| radius, at most most_stabilized_stages() or the odd number behind it; a radius that is NaN gives the
/// fewest.
template <class Polynomials, class Real>
void choose_stages(Real h, Real radius, std::vector<StabilizedStage<Real>>& stages) {
  const Real x = std::abs(h) * radius,
             most = Polynomials::template reach<Real>(most_stabilized_stages<Real>());
  const int s = Polynomials::template stages<Real>(x >= 0 ? std::min(x, most) : Real(0));
  if (s != static_cast<int>(stages.size())) make_stages<Polynomials>(s, stages);
}

}  // namespace hmax
