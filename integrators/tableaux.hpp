/// The explicit Runge-Kutta methods of hmax: data, citation, and the proof of every claim.
#pragma once

#include "integrators/tableau.hpp"
#include <string_view>

namespace hmax::tableaux {

/// Explicit (forward) Euler. [hairer1993solving, I.7]
struct ExplicitEuler {
  static constexpr std::string_view id = "explicit_euler", source = "hairer1993solving";
  static constexpr int order = 1, embedded_order = 0;
  static constexpr ButcherTableau<1> tableau{.a = {}, .b = {1}, .b_err = {}, .c = {0}};
};

/// The classical method of order 4. [kutta1901beitrag]
struct Rk4 {
  static constexpr std::string_view id = "rk4", source = "kutta1901beitrag";
  static constexpr int order = 4, embedded_order = 0;
  static constexpr ButcherTableau<4> tableau{
      .a = {{{}, {1 / 2.0L}, {0, 1 / 2.0L}, {0, 0, 1}}},
      .b = {1 / 6.0L, 1 / 3.0L, 1 / 3.0L, 1 / 6.0L},
      .b_err = {},
      .c = {0, 1 / 2.0L, 1 / 2.0L, 1}};
};

/// Dormand and Prince's pair of order 5(4), the method of MATLAB's ode45; b_err = b - b_hat.
/// [dormand1980family, table 2]; interpolant of order 4: [shampine1986practical].
struct DormandPrince54 {
  static constexpr std::string_view id = "dormand_prince_54", source = "dormand1980family";
  static constexpr int order = 5, embedded_order = 4;
  static constexpr ButcherTableau<7> tableau{
      .a = {{{},
             {1 / 5.0L},
             {3 / 40.0L, 9 / 40.0L},
             {44 / 45.0L, -56 / 15.0L, 32 / 9.0L},
             {19372 / 6561.0L, -25360 / 2187.0L, 64448 / 6561.0L, -212 / 729.0L},
             {9017 / 3168.0L, -355 / 33.0L, 46732 / 5247.0L, 49 / 176.0L, -5103 / 18656.0L},
             {35 / 384.0L, 0, 500 / 1113.0L, 125 / 192.0L, -2187 / 6784.0L, 11 / 84.0L}}},
      .b = {35 / 384.0L, 0, 500 / 1113.0L, 125 / 192.0L, -2187 / 6784.0L, 11 / 84.0L, 0},
      .b_err = {71 / 57600.0L, 0, -71 / 16695.0L, 71 / 1920.0L, -17253 / 339200.0L, 22 / 525.0L, -1 / 40.0L},
      .c = {0, 1 / 5.0L, 3 / 10.0L, 4 / 5.0L, 8 / 9.0L, 1, 1}};
};

}  // namespace hmax::tableaux
