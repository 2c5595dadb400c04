/// The explicit Runge-Kutta methods of hmax: data and citation. Every claim made here is proved by the
/// compiler in tableaux_proof.cpp: row sums, exact order of both methods of a pair, continuous output.
///
/// Of each method: `id`, the bibliography key `source`, `order` of the propagated result, `embedded_order` of
/// its companion and `error_order` with err = O(h^error_order), both 0 where there is no companion;
/// `interpolant` and `interpolant_order` where the literature has continuous output better than cubic Hermite
/// or a free one.
///
/// Limits of h lambda are those of the propagated result: [-r, 0] on the real axis, i [0, s] on the other.
/// R(z) is the stability function, y_new = R(h lambda) y for y' = lambda y.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <tuple>

#include "integrators/explicit/tableau.hpp"
#include "integrators/explicit/tableaux_high_order.hpp"

namespace hmax::tableaux {

/// Explicit (forward) Euler, y_new = y + h f(t, y). R(z) = 1 + z, r = 2, s = 0. [hairer1993solving, I.7]
struct ExplicitEuler {
  static constexpr std::string_view id = "explicit_euler", source = "hairer1993solving";
  static constexpr int order = 1, embedded_order = 0, error_order = 0;
  static constexpr ButcherTableau<1> tableau{.a = {}, .b = {1}, .b_err = {}, .c = {0}};
};

/// The midpoint rule: one Euler step to the middle, whose slope carries the whole step. [runge1895numerische]
///   y_new = y + h f(t + h/2, y + h/2 f(t, y)),   R(z) = 1 + z + z^2/2, r = 2, s = 0
struct Rk2Midpoint {
  static constexpr std::string_view id = "rk2_midpoint", source = "runge1895numerische";
  static constexpr int order = 2, embedded_order = 0, error_order = 0;
  static constexpr ButcherTableau<2> tableau{
      .a = {{{}, {1 / 2.0L}}}, .b = {0, 1}, .b_err = {}, .c = {0, 1 / 2.0L}};
};

/// Heun's method of order 2, the explicit trapezoidal rule. [heun1900neue]
///   y_new = y + h/2 (k_1 + k_2),   k_2 = f(t + h, y + h k_1),   R as for the midpoint rule
struct Rk2Heun {
  static constexpr std::string_view id = "rk2_heun", source = "heun1900neue";
  static constexpr int order = 2, embedded_order = 0, error_order = 0;
  static constexpr ButcherTableau<2> tableau{
      .a = {{{}, {1}}}, .b = {1 / 2.0L, 1 / 2.0L}, .b_err = {}, .c = {0, 1}};
};

/// The two-stage method of order 2 with the smallest bound on its truncation error. [ralston1962runge]
///   y_new = y + h/4 (k_1 + 3 k_2),   k_2 = f(t + 2/3 h, y + 2/3 h k_1),   R as for the midpoint rule
struct Rk2Ralston {
  static constexpr std::string_view id = "rk2_ralston", source = "ralston1962runge";
  static constexpr int order = 2, embedded_order = 0, error_order = 0;
  static constexpr ButcherTableau<2> tableau{
      .a = {{{}, {2 / 3.0L}}}, .b = {1 / 4.0L, 3 / 4.0L}, .b_err = {}, .c = {0, 2 / 3.0L}};
};

/// Kutta's method of order 3, Simpson's rule where f depends on t only. [kutta1901beitrag]
///   R(z) = 1 + z + z^2/2 + z^3/6, r = 2.5127, s = sqrt 3
struct Rk3Kutta {
  static constexpr std::string_view id = "rk3_kutta", source = "kutta1901beitrag";
  static constexpr int order = 3, embedded_order = 0, error_order = 0;
  static constexpr ButcherTableau<3> tableau{.a = {{{}, {1 / 2.0L}, {-1, 2}}},
                                             .b = {1 / 6.0L, 2 / 3.0L, 1 / 6.0L},
                                             .b_err = {},
                                             .c = {0, 1 / 2.0L, 1}};
};

/// Shu and Osher's strong-stability-preserving method of order 3: a convex combination of Euler steps.
/// [shu1988efficient]
///   Y_1 = y + h f(y),   Y_2 = 3/4 y + 1/4 (Y_1 + h f(Y_1)),   y_new = 1/3 y + 2/3 (Y_2 + h f(Y_2))
/// Its SSP coefficient is 1: what an Euler step of size h does not increase, this step does not increase. R
/// is that of every three-stage method of order 3.
struct Ssprk33 {
  static constexpr std::string_view id = "ssprk_33", source = "shu1988efficient";
  static constexpr int order = 3, embedded_order = 0, error_order = 0;
  static constexpr ButcherTableau<3> tableau{.a = {{{}, {1}, {1 / 4.0L, 1 / 4.0L}}},
                                             .b = {1 / 6.0L, 1 / 6.0L, 2 / 3.0L},
                                             .b_err = {},
                                             .c = {0, 1, 1 / 2.0L}};
};

/// The classical method of order 4. [kutta1901beitrag]
///   y_new = y + h/6 (k_1 + 2 k_2 + 2 k_3 + k_4)
///   R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24, r = 2.7853, s = 2 sqrt 2
struct Rk4 {
  static constexpr std::string_view id = "rk4", source = "kutta1901beitrag";
  static constexpr int order = 4, embedded_order = 0, error_order = 0;
  static constexpr ButcherTableau<4> tableau{.a = {{{}, {1 / 2.0L}, {0, 1 / 2.0L}, {0, 0, 1}}},
                                             .b = {1 / 6.0L, 1 / 3.0L, 1 / 3.0L, 1 / 6.0L},
                                             .b_err = {},
                                             .c = {0, 1 / 2.0L, 1 / 2.0L, 1}};
};

/// Kutta's 3/8 rule of order 4. [kutta1901beitrag]
///   y_new = y + h/8 (k_1 + 3 k_2 + 3 k_3 + k_4),   R as for the classical method
struct Rk4ThreeEighths {
  static constexpr std::string_view id = "rk4_38", source = "kutta1901beitrag";
  static constexpr int order = 4, embedded_order = 0, error_order = 0;
  static constexpr ButcherTableau<4> tableau{.a = {{{}, {1 / 3.0L}, {-1 / 3.0L, 1}, {1, -1, 1}}},
                                             .b = {1 / 8.0L, 3 / 8.0L, 3 / 8.0L, 1 / 8.0L},
                                             .b_err = {},
                                             .c = {0, 1 / 3.0L, 2 / 3.0L, 1}};
};

/// Bogacki and Shampine's pair of order 3(2), first same as last, the method of MATLAB's ode23. Continuous
/// output is cubic Hermite interpolation, free of further evaluations. [bogacki1989pair]
/// The result is of order 3 with the R of every three-stage method of order 3, r = 2.5127, s = sqrt 3; the
/// fourth stage f(t + h, y_new) enters the estimate only.
struct BogackiShampine32 {
  static constexpr std::string_view id = "bogacki_shampine_32", source = "bogacki1989pair";
  static constexpr std::array<std::string_view, 1> aliases{"ode23"};
  static constexpr int order = 3, embedded_order = 2, error_order = 3, interpolant_order = 3;
  static constexpr ButcherTableau<4> tableau{
      .a = {{{}, {1 / 2.0L}, {0, 3 / 4.0L}, {2 / 9.0L, 1 / 3.0L, 4 / 9.0L}}},
      .b = {2 / 9.0L, 1 / 3.0L, 4 / 9.0L, 0},
      .b_err = {-5 / 72.0L, 1 / 12.0L, 1 / 9.0L, -1 / 8.0L},
      .c = {0, 1 / 2.0L, 3 / 4.0L, 1}};
  /// Cubic Hermite interpolation through values and slopes at both ends.
  static constexpr auto interpolant = nested_interpolant(tableau);
};

/// Dormand and Prince's pair of order 5(4), first same as last, the method of MATLAB's ode45.
/// [dormand1980family, table 2] Continuous output of order 4, free of further evaluations.
/// [shampine1986practical]
///   R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24 + z^5/120 + z^6/600, r = 3.3066, s = 0.9972
struct DormandPrince54 {
  static constexpr std::string_view id = "dormand_prince_54", source = "dormand1980family";
  static constexpr std::array<std::string_view, 1> aliases{"ode45"};
  static constexpr int order = 5, embedded_order = 4, error_order = 5, interpolant_order = 4;
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
  static constexpr auto interpolant = nested_interpolant<7, 0, 1>(
      tableau,
      {{{-12715105075 / 11282082432.0L, 0, 87487479700 / 32700410799.0L, -10690763975 / 1880347072.0L,
         701980252875 / 199316789632.0L, -1453857185 / 822651844.0L, 69997945 / 29380423.0L}}});
};

/// Tsitouras's pair of order 5(4), first same as last, with continuous output of order 4 free of further
/// evaluations. Published as decimals; the interpolant has 17 to 19 digits of them. [tsitouras2011runge]
struct Tsitouras54 {
  static constexpr std::string_view id = "tsitouras_54", source = "tsitouras2011runge";
  static constexpr int order = 5, embedded_order = 4, error_order = 5, interpolant_order = 4;
  static constexpr ButcherTableau<7> tableau{
      .a = {{{},
             {161 / 1000.0L},
             {-0.008480655492356988544426874250L, 0.335480655492356988544426874250L},
             {2.897153057105493432130432594193L, -6.359448489975074843148159912384L,
              4.362295432869581411017727318191L},
             {5.325864828439256604428877920841L, -11.748883564062827877747170339786L,
              7.495539342889836208304604784565L, -0.092495066361755249256506579332L},
             {5.861455442946420028659251486983L, -12.920969317847109291706118681784L,
              8.159367898576158643180400794539L, -0.071584973281400997224530542526L,
              -0.028269050394068382909003057213L},
             {0.096460766818065229518167313165L, 1 / 100.0L, 0.479889650414499574775249532291L,
              1.379008574103741893192274821857L, -3.290069515436080679901047585711L,
              2.324710524099773982415355918399L}}},
      .b = {0.096460766818065229518167313165L, 1 / 100.0L, 0.479889650414499574775249532291L,
            1.379008574103741893192274821857L, -3.290069515436080679901047585711L,
            2.324710524099773982415355918399L, 0},
      .b_err = {0.001780011052225771443378550608L, 0.000816434459656746903223636063L,
                -0.007880878010261996010314727673L, 0.144711007173262907537165147973L,
                -0.582357165452555225019937610652L, 0.458082105929186946661636518833L, -1 / 66.0L},
      .c = {0, 161 / 1000.0L, 327 / 1000.0L, 9 / 10.0L, 0.980025540904509685729810286287L, 1, 1}};
  static constexpr auto interpolant = nested_interpolant<7, 0, 1>(
      tableau, {{{-1.0530884977290216L, 0.1017L, 2.490627285651252793L, -16.54810288924490272L,
                  47.37952196281928122L, -34.87065786149660974L, 2.5L}}});
};

/// Every explicit Runge-Kutta method of the house; adding one is its struct and its name here.
using All = std::tuple<ExplicitEuler, Rk2Midpoint, Rk2Heun, Rk2Ralston, Rk3Kutta, Ssprk33, Rk4,
                       Rk4ThreeEighths, BogackiShampine32, DormandPrince54, Tsitouras54, Fehlberg78, Dop853>;

/// The further names a method is known by, such as MATLAB's; empty where it has none.
template <class Method>
constexpr std::span<const std::string_view> aliases_of() {
  if constexpr (requires { Method::aliases; }) return Method::aliases;
  return {};
}

}  // namespace hmax::tableaux
