/// The Rosenbrock methods of hmax: data and citation. Every claim made here is proved by the compiler in
/// rosenbrock_proof.cpp.
///
/// Of each method: `id`, the bibliography key `source`, `order` with the exact Jacobian, `w_order` with any
/// matrix in its place (a W-method is one that keeps its order), `embedded_order` and `error_order` with err
/// = O(h^error_order), both 0 without a companion, continuous output and its order, and whether it is
/// A-stable and L-stable.
#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "integrators/rosenbrock_tableau.hpp"

namespace hmax::tableaux {

/// Linearly implicit Euler, one Newton step of implicit Euler; a W-method.
///   (I - h J) k = f(t, y) + h df/dt,   y_new = y + h k
/// On mechanical systems it is (M - h dF/dv - h^2 dF/dx) dv = h (F + h dF/dx v), x += h (v + dv), the step of
/// [baraff1998large]. f + h df/dt stands for f(t + h, y), from which it differs by O(h^2): with it the method
/// is that of the autonomous system with t among its unknowns, like every other of the family.
struct LinearlyImplicitEuler {
  static constexpr std::string_view id = "linearly_implicit_euler", source = "baraff1998large";
  static constexpr std::array<std::string_view, 0> aliases{};
  static constexpr int order = 1, w_order = 1, embedded_order = 0, error_order = 0, interpolant_order = 1;
  static constexpr bool a_stable = true, l_stable = true, stiffly_accurate = false;
  static constexpr RosenbrockTableau<1> tableau{
      .gamma = 1, .a = {}, .c = {}, .m = {1}, .e = {}, .alpha = {0}, .d = {1}};
  static constexpr RosenbrockInterpolant<1, 1> interpolant{{{{1}}}};
};

/// The modified Rosenbrock pair of order 2(3) of MATLAB's ode23s, a W-method; first same as last.
/// [shampine1997matlab, section 3]
///   W = I - h d J,   W k_1 = f_0 + h d T,   W (k_2 - k_1) = f_1 - k_1,
///   W k_3 = f_2 - (6 + sqrt 2)(k_2 - f_1) - 2 (k_1 - f_0) + h d T,   y_new = y + h k_2,
/// with T = df/dt, f_1 at y + h k_1 / 2 and f_2 at y_new. Since W k = k - h d J k, these are the rows below.
struct Rosenbrock23 {
  static constexpr std::string_view id = "rosenbrock_23", source = "shampine1997matlab";
  static constexpr std::array<std::string_view, 1> aliases{"ode23s"};
  static constexpr int order = 2, w_order = 2, embedded_order = 3, error_order = 3, interpolant_order = 2;
  static constexpr bool a_stable = true, l_stable = true, stiffly_accurate = false;

 private:
  static constexpr long double sqrt2 = 1.414213562373095048801688724209698L;
  static constexpr long double gamma = 1 / (2 + sqrt2), e32 = 6 + sqrt2;
  static constexpr RosenbrockForm<3> form{
      .alpha = {{{}, {1 / 2.0L}, {0, 1}}},
      .gamma = {{{gamma}, {-gamma, gamma}, {gamma * (e32 - 2), -gamma* e32, gamma}}},
      .b = {0, 1, 0},
      .b_err = {-1 / 6.0L, 1 / 3.0L, -1 / 6.0L}};

 public:
  /// Where the transformation would leave rounding in place of a zero or a one, the exact number.
  static constexpr RosenbrockTableau<3> tableau = [] {
    auto exact = transformed(form);
    exact.d[1] = 0;
    return exact;
  }();
  static constexpr auto interpolant =
      transformed<3, 2>(form, {{{1 / (1 - 2 * gamma), -1 / (1 - 2 * gamma)},
                                {-2 * gamma / (1 - 2 * gamma), 1 / (1 - 2 * gamma)},
                                {}}});
};

/// RODAS, order 4(3), stiffly accurate, with continuous output of order 3. [hairer1996solving, IV.7 and
/// IV.10]
struct Rodas4 {
  static constexpr std::string_view id = "rodas_4", source = "hairer1996solving";
  static constexpr std::array<std::string_view, 1> aliases{"rodas"};
  static constexpr int order = 4, w_order = 1, embedded_order = 3, error_order = 4, interpolant_order = 3;
  static constexpr bool a_stable = true, l_stable = true, stiffly_accurate = true;
  static constexpr RosenbrockTableau<6> tableau{
      .gamma = 0.25L,
      .a = {{{},
             {1.544L},
             {0.9466785280815826L, 0.2557011698983284L},
             {3.314825187068521L, 2.896124015972201L, 0.9986419139977817L},
             {1.221224509226641L, 6.019134481288629L, 12.53708332932087L, -0.6878860361058950L},
             {1.221224509226641L, 6.019134481288629L, 12.53708332932087L, -0.6878860361058950L, 1}}},
      .c = {{{},
             {-5.6688L},
             {-2.430093356833875L, -0.2063599157091915L},
             {-0.1073529058151375L, -9.594562251023355L, -20.47028614809616L},
             {7.496443313967647L, -10.24680431464352L, -33.99990352819905L, 11.70890893206160L},
             {8.083246795921522L, -7.981132988064893L, -31.52159432874371L, 16.31930543123136L,
              -6.058818238834054L}}},
      .m = {1.221224509226641L, 6.019134481288629L, 12.53708332932087L, -0.6878860361058950L, 1, 1},
      .e = {0, 0, 0, 0, 0, 1},
      .alpha = {0, 0.386L, 0.21L, 0.63L, 1, 1},
      .d = {0.25L, -0.1043L, 0.1035L, -0.0362L, 0, 0}};
  static constexpr auto interpolant =
      rodas_interpolant<6, 2>(tableau.m, {{{10.12623508344586L, -7.487995877610167L, -34.80091861555747L,
                                            -7.992771707568823L, 1.025137723295662L},
                                           {-0.6762803392801253L, 6.087714651680015L, 16.43084320892478L,
                                            24.76722511418386L, -6.594389125716872L}}});
};

/// Rodas5P, order 5(4), stiffly accurate, with continuous output of order 4; made for problems where the
/// order of others breaks down (Prothero and Robinson's, semi-discretised parabolic ones).
/// [steinebach2023construction]
struct Rodas5P {
  static constexpr std::string_view id = "rodas_5p", source = "steinebach2023construction";
  static constexpr std::array<std::string_view, 0> aliases{};
  static constexpr int order = 5, w_order = 2, embedded_order = 4, error_order = 5, interpolant_order = 4;
  static constexpr bool a_stable = true, l_stable = true, stiffly_accurate = true;
  static constexpr RosenbrockTableau<8> tableau{
      .gamma = 0.21193756319429014L,
      .a = {{{},
             {3},
             {2.849394379747939L, 0.45842242204463923L},
             {-6.954028509809101L, 2.489845061869568L, -10.358996098473584L},
             {2.8029986275628964L, 0.5072464736228206L, -0.3988312541770524L, -0.04721187230404641L},
             {-7.502846399306121L, 2.561846144803919L, -11.627539656261098L, -0.18268767659942256L,
              0.030198172008377946L},
             {-7.502846399306121L, 2.561846144803919L, -11.627539656261098L, -0.18268767659942256L,
              0.030198172008377946L, 1},
             {-7.502846399306121L, 2.561846144803919L, -11.627539656261098L, -0.18268767659942256L,
              0.030198172008377946L, 1, 1}}},
      .c = {{{},
             {-14.155112264123755L},
             {-17.97296035885952L, -2.859693295451294L},
             {147.12150275711716L, -1.41221402718213L, 71.68940251302358L},
             {165.43517024871676L, -0.4592823456491126L, 42.90938336958603L, -5.961986721573306L},
             {24.854864614690072L, -3.0009227002832186L, 47.4931110020768L, 5.5814197821558125L,
              -0.6610691825249471L},
             {30.91273214028599L, -3.1208243349937974L, 77.79954646070892L, 34.28646028294783L,
              -19.097331116725623L, -28.087943162872662L},
             {37.80277123390563L, -3.2571969029072276L, 112.26918849496327L, 66.9347231244047L,
              -40.06618937091002L, -54.66780262877968L, -9.48861652309627L}}},
      .m = {-7.502846399306121L, 2.561846144803919L, -11.627539656261098L, -0.18268767659942256L,
            0.030198172008377946L, 1, 1, 1},
      .e = {0, 0, 0, 0, 0, 0, 0, 1},
      .alpha = {0, 0.6358126895828704L, 0.4095798393397535L, 0.9769306725060716L, 0.4288403609558664L, 1, 1,
                1},
      .d = {0.21193756319429014L, -0.42387512638858027L, -0.3384627126235924L, 1.8046452872882734L,
            2.325825639765069L, 0, 0, 0}};
  static constexpr auto interpolant = rodas_interpolant<8, 3>(
      tableau.m, {{{25.948786856663858L, -2.5579724845846235L, 10.433815404888879L, -2.3679251022685204L,
                    0.524948541321073L, 1.1241088310450404L, 0.4272876194431874L, -0.17202221070155493L},
                   {-9.91568850695171L, -0.9689944594115154L, 3.0438037242978453L, -24.495224566215796L,
                    20.176138334709044L, 15.98066361424651L, -6.789040303419874L, -6.710236069923372L},
                   {11.419903575922262L, 2.8879645146136994L, 72.92137995996029L, 80.12511834622643L,
                    -52.072871366152654L, -59.78993625266729L, -0.15582684282751913L, 4.883087185713722L}}});
};

/// Every Rosenbrock method of the house; adding one is its struct and its name here.
using AllRosenbrock = std::tuple<LinearlyImplicitEuler, Rosenbrock23, Rodas4, Rodas5P>;

}  // namespace hmax::tableaux
