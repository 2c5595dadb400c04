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

#include "integrators/implicit/rosenbrock_tableau.hpp"

namespace hmax::tableaux {

/// Linearly implicit Euler, one Newton step of implicit Euler; a W-method.
///   (I - h J) k = f(t, y) + h df/dt,   y_new = y + h k
/// On mechanical systems it is (M - h dF/dv - h^2 dF/dx) dv = h (F + h dF/dx v), x += h (v + dv), the step of
/// [baraff1998large]. f + h df/dt stands for f(t + h, y), from which it differs by O(h^2): with it the method
/// is that of the autonomous system with t among its unknowns, like every other of the family.
/// R(z) = 1 / (1 - z).
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
/// with T = df/dt, f_1 at y + h k_1 / 2 and f_2 at y_new. Since W k = k - h d J k, these are the rows
/// below.
///   d = 1 / (2 + sqrt 2),   R(z) = (1 + (1 - 2 d) z) / (1 - d z)^2,   y_hat - y_new = h/6 (k_1 - 2 k_2 +
///   k_3)
/// The result of order 2 is propagated; that of order 3 only estimates the error. Continuous output:
///   y(t + theta h) = y + h / (1 - 2 d) (theta (1 - theta) k_1 + theta (theta - 2 d) k_2)
struct Rosenbrock23 {
  static constexpr std::string_view id = "rosenbrock_23", source = "shampine1997matlab";
  static constexpr std::array<std::string_view, 1> aliases{"ode23s"};
  static constexpr int order = 2, w_order = 2, embedded_order = 3, error_order = 3, interpolant_order = 2;
  static constexpr bool a_stable = true, l_stable = true, stiffly_accurate = false;

 private:
  static constexpr long double sqrt2 = 1.414213562373095048801688724209698L;
  static constexpr long double gamma = 1 / (2 + sqrt2), e32 = 6 + sqrt2;
  /// With b_err = b - b_hat, so b_hat = (1/6, 2/3, 1/6).
  static constexpr RosenbrockForm<3> form{
      .alpha = {{{}, {1 / 2.0L}, {0, 1}}},
      .gamma = {{{gamma}, {-gamma, gamma}, {gamma * (e32 - 2), -gamma* e32, gamma}}},
      .b = {0, 1, 0},
      .b_err = {-1 / 6.0L, 1 / 3.0L, -1 / 6.0L}};

 public:
  /// In the variables of the stepper, with d_2 = 0 exactly: the transformation would leave rounding there.
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

/// RODAS, order 4(3), gamma = 1/4, six stages. [hairer1996solving, IV.7 and IV.10]
/// Stiffly accurate: y_new is the last argument plus u_6, the embedded result is the last argument: err =
/// u_6. Continuous output is of order 3.
struct Rodas4 {
  static constexpr std::string_view id = "rodas_4", source = "hairer1996solving";
  static constexpr std::array<std::string_view, 1> aliases{"rodas"};
  static constexpr int order = 4, w_order = 1, embedded_order = 3, error_order = 4, interpolant_order = 3;
  static constexpr bool a_stable = true, l_stable = true, stiffly_accurate = true;
  static constexpr RosenbrockTableau<6> tableau{
      .gamma = 0.25L,
      .a = {{{},
             {1.544L},
             {0.946678528081582543939L, 0.255701169898328245301L},
             {3.31482518706852081525L, 2.89612401597220145517L, 0.99864191399778171944L},
             {1.221224509226641888L, 6.01913448128863048578L, 12.5370833293208723413L,
              -0.687886036105895037054L},
             {1.221224509226641888L, 6.01913448128863048578L, 12.5370833293208723413L,
              -0.687886036105895037054L, 1}}},
      .c = {{{},
             {-5.6688L},
             {-2.43009335683387470494L, -0.206359915709191526699L},
             {-0.107352905815137495449L, -9.59456225102335700787L, -20.4702861480961522904L},
             {7.49644331396765168405L, -10.2468043146435240528L, -33.999903528199059407L,
              11.708908932061597544L},
             {8.08324679592152871546L, -7.98113298806489395663L, -31.5215943287437212278L,
              16.319305431231366615L, -6.05881823883405426218L}}},
      .m = {1.221224509226641888L, 6.01913448128863048578L, 12.5370833293208723413L,
            -0.687886036105895037054L, 1, 1},
      .e = {0, 0, 0, 0, 0, 1},
      .alpha = {0, 0.386L, 0.21L, 0.63L, 1, 1},
      .d = {0.25L, -0.1043L, 0.1035L, -0.0362L, 0, 0}};
  /// The rows h_1, h_2 of rodas_interpolant().
  static constexpr auto interpolant = rodas_interpolant<6, 2>(
      tableau.m, {{{10.1262350834458598812L, -7.48799587761017003076L, -34.8009186155574598768L,
                    -7.99277170756882300363L, 1.02513772329566194758L},
                   {-0.676280339280123291552L, 6.08771465167999743239L, 16.4308432089247251156L,
                    24.7672251141838258117L, -6.5943891257168563248L}}});
};

/// Rodas5P, order 5(4), stiffly accurate, with continuous output of order 4; made for problems where the
/// order of others breaks down (Prothero and Robinson's, semi-discretised parabolic ones).
/// [steinebach2023construction] Eight stages, err = u_8 as in RODAS. With an old Jacobian it has order 2.
struct Rodas5P {
  static constexpr std::string_view id = "rodas_5p", source = "steinebach2023construction";
  static constexpr std::array<std::string_view, 0> aliases{};
  static constexpr int order = 5, w_order = 2, embedded_order = 4, error_order = 5, interpolant_order = 4;
  static constexpr bool a_stable = true, l_stable = true, stiffly_accurate = true;
  static constexpr RosenbrockTableau<8> tableau{
      .gamma = 0.21193756319429014L,
      .a = {{{},
             {3},
             {2.84939437974789476517L, 0.458422422044629846118L},
             {-6.95402850980912871882L, 2.48984506186958898707L, -10.3589960984739211671L},
             {2.80299862756280006711L, 0.507246473622829530048L, -0.398831254177099226014L,
              -0.047211872304044274643L},
             {-7.5028463993060882809L, 2.56184614480393093048L, -11.6275396562613000679L,
              -0.182687676599416037302L, 0.0301981720083780985876L},
             {-7.5028463993060882809L, 2.56184614480393093048L, -11.6275396562613000679L,
              -0.182687676599416037302L, 0.0301981720083780985876L, 1},
             {-7.5028463993060882809L, 2.56184614480393093048L, -11.6275396562613000679L,
              -0.182687676599416037302L, 0.0301981720083780985876L, 1, 1}}},
      .c = {{{},
             {-14.1551122641237563748L},
             {-17.972960358859298094L, -2.85969329545128798079L},
             {147.121502757108308633L, -1.41221402718212078606L, 71.6894025130228718193L},
             {165.435170248703208414L, -0.459282345649112894234L, 42.9093833695861645812L,
              -5.96198672157340131767L},
             {24.8548646146899764488L, -3.00092270028325877672L, 47.4931110020753601405L,
              5.58141978215580107008L, -0.661069182524942541961L},
             {30.9127321402851808077L, -3.12082433499374033098L, 77.7995464607058146326L,
              34.2864602829463805879L, -19.0973311167247590578L, -28.0879431628717696243L},
             {37.8027712339051172237L, -3.25719690290723156174L, 112.269188494963278049L,
              66.9347231244078268677L, -40.0661893709124043762L, -54.6678026287826428279L,
              -9.48861652309645576662L}}},
      .m = {-7.5028463993060882809L, 2.56184614480393093048L, -11.6275396562613000679L,
            -0.182687676599416037302L, 0.0301981720083780985876L, 1, 1, 1},
      .e = {0, 0, 0, 0, 0, 0, 0, 1},
      .alpha = {0, 0.63581268958287042L, 0.409579839339748037103L, 0.97693067250607203592L,
                0.42884036095586786248L, 1, 1, 1},
      .d = {0.21193756319429014L, -0.42387512638858028L, -0.338462712623582785662L, 1.80464528728807148654L,
            2.32582563976475666146L, 0, 0, 0}};
  /// The rows h_1, h_2, h_3 of rodas_interpolant().
  static constexpr auto interpolant = rodas_interpolant<8, 3>(
      tableau.m, {{{25.9487868566652649035L, -2.55797248458456014103L, 10.4338154048904049915L,
                    -2.36792510226827807218L, 0.52494854132081219224L, 1.12410883104469806415L,
                    0.427287619442942577462L, -0.172022210701685229341L},
                   {-9.9156885069601718062L, -0.968994459411955040971L, 3.04380372429672430969L,
                    -24.4952245662141198293L, 20.1761383347087588548L, 15.9806636142460354184L,
                    -6.78904030341923955262L, -6.7102360699242066306L},
                   {11.419903575927460651L, 2.88796451461416630431L, 72.9213799599553202924L,
                    80.1251183462222639048L, -52.0728713661508031233L, -59.7899362526650886771L,
                    -0.155826842827743871933L, 4.8830871857132805644L}}});
};

/// Every Rosenbrock method of the house; adding one is its struct and its name here.
using AllRosenbrock = std::tuple<LinearlyImplicitEuler, Rosenbrock23, Rodas4, Rodas5P>;

}  // namespace hmax::tableaux
