#include "integrators/explicit/tableaux.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/explicit/tableau_claims.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using tableaux::BogackiShampine32;
using tableaux::Dop853;
using tableaux::DormandPrince54;
using tableaux::Fehlberg78;
using tableaux::Tsitouras54;

template <class Method>
class EveryTableau : public ::testing::Test {};
TYPED_TEST_SUITE(EveryTableau, EveryMethod, MethodId);

template <std::size_t S>
using Row = std::array<long double, S>;

template <std::size_t S>
Row<S> applied(const std::array<Row<S>, S>& a, const Row<S>& x) {
  Row<S> y{};
  for (std::size_t i = 0; i < S; ++i)
    for (std::size_t j = 0; j < S; ++j) y[i] += a[i][j] * x[j];
  return y;
}

template <std::size_t S>
long double dot(const Row<S>& x, const Row<S>& y) {
  long double sum = 0;
  for (std::size_t i = 0; i < S; ++i) sum += x[i] * y[i];
  return sum;
}

template <std::size_t S>
Row<S> powers(const Row<S>& c, int k) {
  Row<S> result{};
  for (std::size_t i = 0; i < S; ++i) result[i] = std::pow(c[i], static_cast<long double>(k));
  return result;
}

/// The coefficients of R(z) = 1 + sum_k (b^T A^(k-1) 1) z^k, from z^0 on.
template <std::size_t S>
std::vector<long double> stability_polynomial(const ButcherTableau<S>& tableau, bool embedded = false) {
  Row<S> b = tableau.b, x;
  for (std::size_t i = 0; embedded && i < S; ++i) b[i] -= tableau.b_err[i];
  x.fill(1);
  std::vector<long double> coefficients{1};
  for (std::size_t k = 0; k < S; ++k) {
    coefficients.push_back(dot(b, x));
    x = applied(tableau.a, x);
  }
  return coefficients;
}

void expect_coefficients(const std::vector<long double>& found, const std::vector<long double>& expected) {
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_NEAR(static_cast<double>(found[k]), static_cast<double>(k < expected.size() ? expected[k] : 0),
                1e-16)
        << "coefficient of z^" << k;
}

TYPED_TEST(EveryTableau, SatisfiesConditionsOfMixedTreesWrittenOutByHand) {
  const auto& [a, b, b_err, c] = TypeParam::tableau;
  const auto one = powers(c, 0), c2 = powers(c, 2), c3 = powers(c, 3);
  auto times = [](auto x, const auto& y) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] *= y[i];
    return x;
  };
  const auto ac = applied(a, c), ac2 = applied(a, c2), ac3 = applied(a, c3), aac = applied(a, ac),
             acac = applied(a, times(c, ac));
  struct Condition {
    int order;
    long double left, right;
  };
  // [hairer1993solving, table II.2.2] for orders 3 to 5, and four of the 20 of order 6.
  const Condition conditions[] = {
      {3, dot(b, ac), 1 / 6.0L},
      {4, dot(b, times(c, ac)), 1 / 8.0L},
      {4, dot(b, ac2), 1 / 12.0L},
      {5, dot(b, times(c2, ac)), 1 / 10.0L},
      {5, dot(b, times(c, ac2)), 1 / 15.0L},
      {5, dot(b, times(c, aac)), 1 / 30.0L},
      {5, dot(b, times(ac, ac)), 1 / 20.0L},
      {5, dot(b, ac3), 1 / 20.0L},
      {5, dot(b, acac), 1 / 40.0L},
      {5, dot(b, applied(a, ac2)), 1 / 60.0L},
      {6, dot(b, times(c3, ac)), 1 / 12.0L},
      {6, dot(b, times(ac, ac2)), 1 / 36.0L},
      {6, dot(b, applied(a, ac3)), 1 / 120.0L},
      {6, dot(b, applied(a, times(c, ac2))), 1 / 90.0L},
  };
  for (const Condition& condition : conditions) {
    if (condition.order > TypeParam::order) continue;
    EXPECT_NEAR(static_cast<double>(condition.left - condition.right), 0, 1e-15)
        << "order " << condition.order;
  }
  EXPECT_NEAR(static_cast<double>(dot(b, one)), 1, 1e-16);
}

TYPED_TEST(EveryTableau, NoticesAChangeInARowThatKeepsTheRowSum) {
  // The row check is blind to these: only the order conditions see them.
  if constexpr (TypeParam::order >= 3) {
    constexpr auto tableau = TypeParam::tableau;
    for (std::size_t i = 2; i < tableau.stages; ++i) {
      for (std::size_t j = 1; j < i; ++j) {
        auto mutant = tableau;
        mutant.a[i][j] += 1e-3L;
        mutant.a[i][0] -= 1e-3L;
        ASSERT_TRUE(rows_are_consistent(mutant));
        EXPECT_NE(broken_claim<TypeParam>(mutant), BrokenClaim::none) << "a[" << i << "][" << j << "]";
      }
    }
  }
}

TYPED_TEST(EveryTableau, HasALastDigitCorrectInLongDouble) {
  // Fractions written with double literals would be off by 1e-17 and more.
  for (std::size_t i = 0; i < TypeParam::tableau.stages; ++i) {
    long double sum = 0;
    for (const long double entry : TypeParam::tableau.a[i]) sum += entry;
    EXPECT_NEAR(static_cast<double>(sum - TypeParam::tableau.c[i]), 0, 1e-17) << "row " << i;
  }
}

TEST(Tableaux, NamesAreUniqueAndAliasesPointAtMatlabsMethods) {
  std::set<std::string_view> names;
  std::size_t count = 0;
  std::apply(
      [&]<class... Methods>(Methods...) {
        ((names.insert(Methods::id), ++count), ...);
        auto insert_aliases = [&](auto aliases) {
          for (const auto alias : aliases) names.insert(alias), ++count;
        };
        (insert_aliases(tableaux::aliases_of<Methods>()), ...);
      },
      tableaux::All{});
  EXPECT_EQ(names.size(), count);
  EXPECT_EQ(count, 15u);
  EXPECT_EQ(tableaux::aliases_of<DormandPrince54>()[0], "ode45");
  EXPECT_EQ(tableaux::aliases_of<BogackiShampine32>()[0], "ode23");
}

TEST(DormandPrince54, HasThePublishedStabilityFunctions) {
  expect_coefficients(stability_polynomial(DormandPrince54::tableau),
                      {1, 1, 1 / 2.0L, 1 / 6.0L, 1 / 24.0L, 1 / 120.0L, 1 / 600.0L});
  expect_coefficients(stability_polynomial(DormandPrince54::tableau, true),
                      {1, 1, 1 / 2.0L, 1 / 6.0L, 1 / 24.0L, 1097 / 120000.0L, 161 / 120000.0L, 1 / 24000.0L});
}

TEST(BogackiShampine32, HasThePublishedStabilityFunctions) {
  expect_coefficients(stability_polynomial(BogackiShampine32::tableau), {1, 1, 1 / 2.0L, 1 / 6.0L});
  expect_coefficients(stability_polynomial(BogackiShampine32::tableau, true),
                      {1, 1, 1 / 2.0L, 3 / 16.0L, 1 / 48.0L});
}

TEST(Fehlberg78, EstimatesZeroErrorOnAnyFunctionOfTime) {
  // Its known weakness, documented at the data: the stages of the estimate come in pairs of equal nodes.
  const auto& t = Fehlberg78::tableau;
  EXPECT_EQ(t.b_err[0], -t.b_err[11]);
  EXPECT_EQ(t.c[0], t.c[11]);
  EXPECT_EQ(t.b_err[10], -t.b_err[12]);
  EXPECT_EQ(t.c[10], t.c[12]);
}

/// b_i(theta) of an interpolant.
template <std::size_t S, std::size_t E, std::size_t D>
long double weight(const Interpolant<S, E, D>& interpolant, std::size_t i, long double theta) {
  long double sum = 0;
  for (std::size_t j = D; j-- > 0;) sum = theta * (interpolant.p[i][j] + sum);
  return sum;
}

TEST(BogackiShampine32, InterpolatesByTheCubicHermiteFormula) {
  // y(theta) = ... + h [theta (1 - theta)^2 f_0 - theta^2 (1 - theta) f_1] + theta^2 (3 - 2 theta) (y_1 -
  // y_0)
  const auto& b = BogackiShampine32::tableau.b;
  for (const long double theta : {0.1L, 0.5L, 0.8L, 1.0L}) {
    for (std::size_t i = 0; i < 4; ++i) {
      long double expected = theta * theta * (3 - 2 * theta) * b[i];
      if (i == 0) expected += theta * (1 - theta) * (1 - theta);
      if (i == 3) expected -= theta * theta * (1 - theta);
      EXPECT_NEAR(static_cast<double>(weight(BogackiShampine32::interpolant, i, theta) - expected), 0, 1e-18);
    }
  }
}

TEST(Tsitouras54, InterpolatesByThePublishedWeights) {
  // The factored form of the publication, section 4; it gives the roots to 16 digits.
  for (const long double x : {0.1L, 0.5L, 0.8L, 1.0L}) {
    const long double published[] = {
        -1.0530884977290216L * x * (x - 1.3299890189751412L) *
            (x * x - 1.4364028541716351L * x + 0.7139816917074209L),
        0.1017L * x * x * (x * x - 2.1966568338249754L * x + 1.2949852507374631L),
        2.490627285651252793L * x * x * (x * x - 2.38535645472061657L * x + 1.57803468208092486L),
        -16.54810288924490272L * (x - 1.21712927295533244L) * (x - 0.61620406037800089L) * x * x,
        47.37952196281928122L * (x - 1.203071208372362603L) * (x - 0.658047292653547382L) * x * x,
        -34.87065786149660974L * (x - 1.2L) * (x - 2 / 3.0L) * x * x,
        2.5L * (x - 1) * (x - 0.6L) * x * x};
    for (std::size_t i = 0; i < 7; ++i)
      EXPECT_NEAR(static_cast<double>(weight(Tsitouras54::interpolant, i, x) - published[i]), 0, 1e-14)
          << "stage " << i;
  }
}

template <class Method>
class EveryInterpolant : public ::testing::Test {};
using Interpolated = ::testing::Types<BogackiShampine32, DormandPrince54, Tsitouras54, Dop853>;
TYPED_TEST_SUITE(EveryInterpolant, Interpolated, MethodId);

TYPED_TEST(EveryInterpolant, IsExactOnPowersOfTimeAllAlongTheStep) {
  constexpr auto all = extended(TypeParam::tableau, TypeParam::interpolant);
  for (const long double theta : {0.0L, 0.3L, 0.77L, 1.0L}) {
    for (int q = 1; q <= TypeParam::interpolant_order; ++q) {
      long double sum = 0;
      for (std::size_t i = 0; i < all.stages; ++i)
        sum += weight(TypeParam::interpolant, i, theta) * std::pow(all.c[i], static_cast<long double>(q - 1));
      EXPECT_NEAR(static_cast<double>(sum - std::pow(theta, static_cast<long double>(q)) / q), 0, 1e-15);
    }
  }
}

TYPED_TEST(EveryInterpolant, LeavesAndArrivesWithTheSlopeOfTheSystem) {
  // b_i'(0) = 1 for the first stage and b_i'(1) = 1 for f at the new point, 0 for every other one.
  const auto& p = TypeParam::interpolant.p;
  for (std::size_t i = 0; i < p.size(); ++i) {
    long double at_end = 0;
    for (std::size_t j = 0; j < p[i].size(); ++j) at_end += static_cast<long double>(j + 1) * p[i][j];
    EXPECT_NEAR(static_cast<double>(p[i][0]), i == 0 ? 1 : 0, 1e-15);
    EXPECT_NEAR(static_cast<double>(at_end), i + 1 == TypeParam::tableau.stages ? 1 : 0, 1e-13);
  }
}

TEST(OrderOf, KnowsImplicitMethodsToo) {
  // Gauss's method of two stages has order 4; implicit Euler 1.
  const long double r = std::sqrt(3.0L) / 6;
  const std::array<long double, 4> gauss{0.25L, 0.25L - r, 0.25L + r, 0.25L};
  const std::array<long double, 2> half{0.5L, 0.5L};
  EXPECT_EQ(order_of(gauss, half), 4);
  const std::array<long double, 1> one{1};
  EXPECT_EQ(order_of(one, one), 1);
}

TEST(VisitTrees, CountsTheRootedTrees) {
  // 1, 1, 2, 4, 9, 20, 48, 115, 286, 719 trees of 1 to 10 nodes [hairer1993solving, table II.2.1].
  const std::array<long double, 1> a{0};
  std::array<int, 11> count{};
  visit_trees(a, 1, 10,
              [&](int nodes, long double, std::span<const long double>) { return ++count[nodes] > 0; });
  EXPECT_EQ(count, (std::array<int, 11>{0, 1, 1, 2, 4, 9, 20, 48, 115, 286, 719}));
}

}  // namespace
}  // namespace hmax
