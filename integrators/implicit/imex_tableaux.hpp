/// Additive Runge-Kutta pairs as constexpr data: the nonstiff part of f is stepped by the explicit half, the
/// stiff part by the diagonally implicit one, both with the same stages. imex_tableaux_proof.cpp proves every
/// order claimed here, coupling conditions included.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <tuple>

#include "integrators/explicit/tableau.hpp"

namespace hmax {

/// The two halves of f = nonstiff + stiff:
///   Y_i = y + h sum_j (aE_ij nonstiff(Y_j) + aI_ij stiff(Y_j)),   f at t + c_i h in both,
///   y_new = y + h sum_i (bE_i nonstiff(Y_i) + bI_i stiff(Y_i)),   and the error likewise.
template <std::size_t Stages>
struct AdditiveTableau {
  static constexpr std::size_t stages = Stages;  ///< s, of both halves
  ButcherTableau<Stages> nonstiff, stiff;        ///< the explicit and the implicit half, with the same nodes
};

/// The order of the propagated weights, or of the embedded ones: the largest p <= max_order for which every
/// tree t with at most p nodes, each of any colour, satisfies  sum_i b_i g_i(t) = 1 / gamma(t)  with the b of
/// the colour of its root [kennedy2003additive].
template <std::size_t S>
constexpr int order_of(const AdditiveTableau<S>& tableau, bool embedded, int max_order,
                       long double tolerance = 1e-15L) {
  const auto a = std::array{detail::flattened(tableau.nonstiff.a), detail::flattened(tableau.stiff.a)};
  const std::array<const ButcherTableau<S>*, 2> halves{&tableau.nonstiff, &tableau.stiff};
  // Colour 0: nonstiff, colour 1: stiff. Each tree has one condition for each colour of its root.
  const std::array<std::span<const long double>, 2> parts{a[0], a[1]};
  int order = max_order;
  visit_trees(parts, S, max_order, [&](int nodes, long double gamma, std::span<const long double> g) {
    for (const ButcherTableau<S>* half : halves) {
      long double sum = 0;
      // sum_i b_i g_i or sum_i b_hat_i g_i
      for (std::size_t i = 0; i < S; ++i) sum += (embedded ? half->b[i] - half->b_err[i] : half->b[i]) * g[i];
      if (detail::magnitude(sum - 1 / gamma) > tolerance) order = nodes - 1;
    }
    return order == max_order;
  });
  return order;
}

/// What the stepper takes for granted: the explicit half needs no stage before it is there; the implicit one
/// needs itself at most, with one gamma wherever it does, which is not in the first stage; both have the same
/// nodes, to which their rows sum.
template <std::size_t S>
constexpr bool is_imex(const AdditiveTableau<S>& tableau) {
  const auto& [nonstiff, stiff] = tableau;
  if (!is_explicit(nonstiff) || !rows_are_consistent(nonstiff) || !rows_are_consistent(stiff)) return false;
  for (std::size_t i = 0; i < S; ++i) {
    // Common nodes; gamma on the diagonal but for the first, explicit stage; zeros above.
    if (nonstiff.c[i] != stiff.c[i]) return false;
    if (stiff.a[i][i] != (i == 0 ? 0 : stiff.a[S - 1][S - 1])) return false;
    for (std::size_t j = i + 1; j < S; ++j)
      if (stiff.a[i][j] != 0) return false;
  }
  return true;
}

/// Whether a tableau, its own unless another one is given, keeps every claim of `Method`: orders that are
/// reached and not exceeded, by both methods of a pair, over all trees of two colours; an implicit half whose
/// last stage is the result; error weights only where there is a companion.
template <class Method>
constexpr bool keeps_its_claims(const decltype(Method::tableau)& tableau = Method::tableau) {
  // Exactly this order: reached, and not exceeded.
  const auto has_order = [&](bool embedded, int order) {
    return order_of(tableau, embedded, order + 1) == order;
  };
  const auto& [nonstiff, stiff] = tableau;
  if (!is_imex(tableau) || !is_stiffly_accurate(stiff) || !has_order(false, Method::order)) return false;
  for (const auto* half : {&nonstiff, &stiff})
    if (has_error_estimate(*half) != (Method::embedded_order > 0)) return false;
  if (Method::error_order != (Method::embedded_order > 0 ? Method::embedded_order + 1 : 0)) return false;
  return Method::embedded_order == 0 || has_order(true, Method::embedded_order);
}

namespace tableaux {

/// Explicit and implicit Euler: y_new = y + h nonstiff(t, y) + h stiff(t + h, y_new) [ascher1997implicit].
/// For y' = i nu y + lambda y, the first term nonstiff, y_new / y = (1 + i h nu) / (1 - h lambda).
struct ImexEuler {
  static constexpr std::string_view id = "imex_euler", source = "ascher1997implicit";
  static constexpr int order = 1, embedded_order = 0, error_order = 0;
  static constexpr AdditiveTableau<2> tableau{
      .nonstiff = {.a = {{{0, 0}, {1, 0}}}, .b = {1, 0}, .b_err = {}, .c = {0, 1}},
      .stiff = {.a = {{{0, 0}, {0, 1}}}, .b = {0, 1}, .b_err = {}, .c = {0, 1}}};
};

namespace detail {
/// Both halves of a pair with common weights b, embedded weights b_hat and nodes c.
template <std::size_t S>
constexpr AdditiveTableau<S> common_weights(const std::array<std::array<long double, S>, S>& nonstiff,
                                            const std::array<std::array<long double, S>, S>& stiff,
                                            const std::array<long double, S>& b,
                                            const std::array<long double, S>& b_hat,
                                            const std::array<long double, S>& c) {
  std::array<long double, S> b_err{};
  for (std::size_t i = 0; i < S; ++i) b_err[i] = b[i] - b_hat[i];
  return {.nonstiff = {.a = nonstiff, .b = b, .b_err = b_err, .c = c},
          .stiff = {.a = stiff, .b = b, .b_err = b_err, .c = c}};
}
}  // namespace detail

/// ARK3(2)4L[2]SA [kennedy2003additive]: order 3(2), four stages, common weights of both halves. The
/// implicit half is L-stable, stiffly accurate, of stage order two.
struct ImexArk324 {
  static constexpr std::string_view id = "imex_ark_324", source = "kennedy2003additive";
  static constexpr int order = 3, embedded_order = 2, error_order = 3;
  static constexpr long double gamma = 1767732205903.0L / 4055673282236.0L;
  /// The weights, and the last row of the implicit half.
  static constexpr std::array<long double, 4> b{1471266399579.0L / 7840856788654.0L,
                                                -4482444167858.0L / 7529755066697.0L,
                                                11266239266428.0L / 11593286722821.0L, gamma};
  /// In the order of common_weights(): nonstiff a, stiff a, b, b_hat, c.
  static constexpr AdditiveTableau<4> tableau = detail::common_weights<4>(
      {{{},
        {1767732205903.0L / 2027836641118.0L},
        {5535828885825.0L / 10492691773637.0L, 788022342437.0L / 10882634858940.0L},
        {6485989280629.0L / 16251701735622.0L, -4246266847089.0L / 9704473918619.0L,
         10755448449292.0L / 10357097424841.0L}}},
      {{{},
        {gamma, gamma},
        {2746238789719.0L / 10658868560708.0L, -640167445237.0L / 6845629431997.0L, gamma},
        b}},
      b,
      {2756255671327.0L / 12835298489170.0L, -10771552573575.0L / 22201958757719.0L,
       9247589265047.0L / 10645013368117.0L, 2193209047091.0L / 5459859503100.0L},
      {0, 2 * gamma, 0.6L, 1});
};

/// ARK4(3)6L[2]SA [kennedy2003additive]: the same with order 4(3), six stages and gamma = 1/4.
struct ImexArk436 {
  static constexpr std::string_view id = "imex_ark_436", source = "kennedy2003additive";
  static constexpr int order = 4, embedded_order = 3, error_order = 4;
  /// The weights, and the last row of the implicit half.
  static constexpr std::array<long double, 6> b{
      82889.0L / 524892.0L, 0, 15625.0L / 83664.0L, 69875.0L / 102672.0L, -2260.0L / 8211.0L, 0.25L};
  /// In the order of common_weights(): nonstiff a, stiff a, b, b_hat, c.
  static constexpr AdditiveTableau<6> tableau = detail::common_weights<6>(
      {{{},
        {0.5L},
        {13861.0L / 62500.0L, 6889.0L / 62500.0L},
        {-116923316275.0L / 2393684061468.0L, -2731218467317.0L / 15368042101831.0L,
         9408046702089.0L / 11113171139209.0L},
        {-451086348788.0L / 2902428689909.0L, -2682348792572.0L / 7519795681897.0L,
         12662868775082.0L / 11960479115383.0L, 3355817975965.0L / 11060851509271.0L},
        {647845179188.0L / 3216320057751.0L, 73281519250.0L / 8382639484533.0L,
         552539513391.0L / 3454668386233.0L, 3354512671639.0L / 8306763924573.0L, 4040.0L / 17871.0L}}},
      {{{},
        {0.25L, 0.25L},
        {8611.0L / 62500.0L, -1743.0L / 31250.0L, 0.25L},
        {5012029.0L / 34652500.0L, -654441.0L / 2922500.0L, 174375.0L / 388108.0L, 0.25L},
        {15267082809.0L / 155376265600.0L, -71443401.0L / 120774400.0L, 730878875.0L / 902184768.0L,
         2285395.0L / 8070912.0L, 0.25L},
        b}},
      b,
      {4586570599.0L / 29645900160.0L, 0, 178811875.0L / 945068544.0L, 814220225.0L / 1159782912.0L,
       -3700637.0L / 11593932.0L, 61727.0L / 225920.0L},
      {0, 0.5L, 83.0L / 250.0L, 31.0L / 50.0L, 17.0L / 20.0L, 1});
};

/// Every additive pair, in the order in which they are listed.
using AllImex = std::tuple<ImexEuler, ImexArk324, ImexArk436>;

}  // namespace tableaux
}  // namespace hmax
