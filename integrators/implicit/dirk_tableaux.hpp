/// The diagonally implicit Runge-Kutta methods of hmax: data and citation. Every claim made here is proved by
/// the compiler in dirk_tableaux_proof.cpp: the shape of a, row sums, exact order of both methods of a pair,
/// continuous output, the constant of an error.
///
/// Of each method, besides what tableaux.hpp says: `gamma`, the one number on the diagonal of its implicit
/// stages (an explicit first stage is allowed); `a_stable` and `l_stable`; `inner_stage`, a stage whose value
/// is a point of the solution, where continuous output is cubic Hermite on both sides of it;
/// `third_derivative_error`, C of a method whose error is C h^3 y''' and that estimates it from the slopes of
/// two steps instead of an embedded method; `damps_error`, whether (I - h gamma J)^-1 is applied to the
/// error.
#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "integrators/explicit/tableau.hpp"

namespace hmax::tableaux {

/// Implicit (backward) Euler; its slope at the start, known from the step before, serves only the error
/// estimate h / 2 (k_2 - k_1), the distance to the trapezoidal rule. [hairer1996solving, IV.3]
///   y_new = y + h f(t + h, y_new),   R(z) = 1 / (1 - z)
struct ImplicitEuler {
  static constexpr std::string_view id = "implicit_euler", source = "hairer1996solving";
  static constexpr int order = 1, embedded_order = 2, error_order = 2;
  static constexpr bool a_stable = true, l_stable = true;
  static constexpr long double gamma = 1;
  static constexpr ButcherTableau<2> tableau{
      .a = {{{}, {0, 1}}}, .b = {0, 1}, .b_err = {-1 / 2.0L, 1 / 2.0L}, .c = {0, 1}};
};

/// The trapezoidal rule, MATLAB's ode23t: y_new = y + h/2 (f(t, y) + f(t + h, y_new)).
///   R(z) = (1 + z/2) / (1 - z/2),   y(t + h) - y_new = -h^3/12 d^3y/dt^3 + O(h^4)
/// |R(iy)| = 1 and R(-infinity) = -1. It does not damp stiff
/// components and does not reach the end of Robertson's problem (docs/reference/facts.md). Cubic Hermite
/// interpolation between its ends is free; there it is a quadratic, and the jump of its second derivative
/// from step to step tells the third. [shampine1999solving]
struct Trapezoidal {
  static constexpr std::string_view id = "trapezoidal", source = "shampine1999solving";
  static constexpr std::array<std::string_view, 1> aliases{"ode23t"};
  static constexpr int order = 2, embedded_order = 0, error_order = 3;
  static constexpr bool a_stable = true, l_stable = false;
  static constexpr long double gamma = 1 / 2.0L, third_derivative_error = 1 / 12.0L;
  static constexpr ButcherTableau<2> tableau{
      .a = {{{}, {1 / 2.0L, 1 / 2.0L}}}, .b = {1 / 2.0L, 1 / 2.0L}, .b_err = {}, .c = {0, 1}};
};

/// The implicit midpoint rule, the Gauss method of one stage: symplectic. [hairer2006geometric, II.1]
///   y_new = y + h k,   k = f(t + h/2, y + h/2 k),   R(z) = (1 + z/2) / (1 - z/2)
struct ImplicitMidpoint {
  static constexpr std::string_view id = "implicit_midpoint", source = "hairer2006geometric";
  static constexpr int order = 2, embedded_order = 0, error_order = 0;
  static constexpr bool a_stable = true, l_stable = false;
  static constexpr long double gamma = 1 / 2.0L;
  static constexpr ButcherTableau<1> tableau{.a = {{{1 / 2.0L}}}, .b = {1}, .b_err = {}, .c = {1 / 2.0L}};
};

/// TR-BDF2, MATLAB's ode23tb: the trapezoidal rule to t + (2 - sqrt 2) h, then the BDF of order 2 to the end,
/// with the same matrix. Its companion of order 3 estimates the error. [hosea1996analysis]
///   Y = y + gamma h (f(t, y) + f(t + 2 gamma h, Y)),   gamma = 1 - sqrt(2) / 2,
///   y_new = y + h (w f(t, y) + w f(t + 2 gamma h, Y) + gamma f(t + h, y_new)),   w = sqrt(2) / 4
struct TrBdf2 {
 private:
  static constexpr long double root2 = 1.41421356237309504880168872420969807857L, w = root2 / 4;

 public:
  static constexpr std::string_view id = "tr_bdf2", source = "hosea1996analysis";
  static constexpr std::array<std::string_view, 1> aliases{"ode23tb"};
  static constexpr int order = 2, embedded_order = 3, error_order = 3;
  static constexpr bool a_stable = true, l_stable = true;
  static constexpr long double gamma = 1 - root2 / 2;
  static constexpr std::size_t inner_stage = 1;
  static constexpr bool damps_error = true;
  /// b_hat = ((1 - w) / 3, (3 w + 1) / 3, gamma / 3).
  static constexpr ButcherTableau<3> tableau{
      .a = {{{}, {gamma, gamma}, {w, w, gamma}}},
      .b = {w, w, gamma},
      .b_err = {w - (1 - w) / 3, w - (3 * w + 1) / 3, gamma - gamma / 3},
      .c = {0, 2 * gamma, 1}};
};

/// SDIRK of order 4(3) with five stages and gamma = 1/4, L-stable and stiffly accurate.
/// [hairer1996solving, IV.6 table 6.5 and (6.16)] Continuous output of order 3 is a polynomial of degree 4.
struct Sdirk4 {
  static constexpr std::string_view id = "sdirk_4", source = "hairer1996solving";
  static constexpr int order = 4, embedded_order = 3, error_order = 4, interpolant_order = 3;
  static constexpr bool a_stable = true, l_stable = true;
  static constexpr long double gamma = 1 / 4.0L;
  static constexpr bool damps_error = true;
  static constexpr ButcherTableau<5> tableau{
      .a = {{{gamma},
             {1 / 2.0L, gamma},
             {17 / 50.0L, -1 / 25.0L, gamma},
             {371 / 1360.0L, -137 / 2720.0L, 15 / 544.0L, gamma},
             {25 / 24.0L, -49 / 48.0L, 125 / 16.0L, -85 / 12.0L, gamma}}},
      .b = {25 / 24.0L, -49 / 48.0L, 125 / 16.0L, -85 / 12.0L, gamma},
      .b_err = {-3 / 16.0L, -27 / 32.0L, 25 / 32.0L, 0, gamma},
      .c = {gamma, 3 / 4.0L, 11 / 20.0L, 1 / 2.0L, 1}};
  static constexpr Interpolant<5, 0, 4> interpolant{
      .p = {{{11 / 3.0L, -463 / 72.0L, 217 / 36.0L, -20 / 9.0L},
             {11 / 2.0L, -385 / 16.0L, 661 / 24.0L, -10},
             {-125 / 18.0L, 20125 / 432.0L, -8875 / 216.0L, 250 / 27.0L},
             {0, -85 / 4.0L, 85 / 6.0L, 0},
             {-11 / 9.0L, 557 / 108.0L, -359 / 54.0L, 80 / 27.0L}}},
      .a = {},
      .c = {}};
};

/// Every diagonally implicit method of the catalogue, in the order in which they are listed.
using AllDiagonallyImplicit = std::tuple<ImplicitEuler, Trapezoidal, ImplicitMidpoint, TrBdf2, Sdirk4>;

}  // namespace hmax::tableaux
