/// Tableaux of users are checked when they are made.
#include "integrators/explicit/user_tableau.hpp"

#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/own_tableau.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TableauRows heun() {
  return {.name = "heun", .a = {{}, {1}}, .b = {1 / 2.0L, 1 / 2.0L}, .b_hat = {1, 0}, .c = {0, 1}};
}

std::string complaint(const TableauRows& rows) {
  return error_of<std::invalid_argument>([&] { runtime_tableau(rows); });
}

TEST(UserTableau, ComputesOrdersAndNodes) {
  const RuntimeTableau tableau = runtime_tableau(heun());
  EXPECT_EQ(tableau.computed_order, 2);
  EXPECT_EQ(tableau.embedded_order, 1);
  EXPECT_EQ(tableau.c, (std::vector<long double>{0, 1}));
  EXPECT_FALSE(tableau.fsal);
}

TEST(UserTableau, IsTheSameMethodAsTheTableauOfTheCompiler) {
  using Known = tableaux::DormandPrince54;
  const RuntimeTableau tableau = runtime_tableau<Known>();
  EXPECT_EQ(tableau.name, Known::id);
  EXPECT_EQ(tableau.computed_order, Known::order);
  EXPECT_EQ(tableau.embedded_order, Known::embedded_order);
  EXPECT_TRUE(tableau.fsal);
  for (std::size_t i = 0; i < Known::tableau.stages; ++i) EXPECT_EQ(tableau.b[i], Known::tableau.b[i]);
}

TEST(UserTableau, RefusesCoefficientsThatMakeNoMethodInOneSentence) {
  TableauRows rows = heun();
  rows.b = {0.5L, 0.6L};
  EXPECT_TRUE(says(complaint(rows), "the weights b sum to 1.1 and not to 1"));
  rows = heun();
  rows.a[0] = {0, 0.25L};
  EXPECT_TRUE(says(complaint(rows), "row 1 of a has a nonzero entry in column 2"));
  rows = heun();
  rows.c[1] = 0.5L;
  EXPECT_TRUE(says(complaint(rows), "row 2 of a sums to 1 but entry 2 of c is 0.5"));
  rows = heun();
  rows.a.pop_back();
  EXPECT_TRUE(says(complaint(rows), "a has 1 rows but b has 2"));
  rows = heun();
  rows.b_hat = {1};
  EXPECT_TRUE(says(complaint(rows), "b_hat has 1 entries but b has 2"));
  rows = heun();
  rows.b_hat = rows.b;
  EXPECT_TRUE(says(complaint(rows), "b_hat equals b"));
  rows = heun();
  rows.a[1][0] = std::numeric_limits<long double>::quiet_NaN();
  EXPECT_TRUE(says(complaint(rows), "not finite"));
  EXPECT_TRUE(says(complaint({.name = "none", .a = {}, .b = {}}), "b is empty"));
}

std::string complaint_of_stepper(const RuntimeTableau& tableau) {
  return error_of<std::invalid_argument>(
      [&] { ExplicitRk<RuntimeTableau, Eigen::VectorXd> stepper(tableau); });
}

TEST(UserTableau, FilledInByHandIsCheckedByTheStepper) {
  const RuntimeTableau right = runtime_tableau(heun());
  EXPECT_EQ(complaint_of_stepper(right), "");
  RuntimeTableau tableau = right;
  tableau.b = {0.5L, 0.417L};
  EXPECT_TRUE(says(complaint_of_stepper(tableau), "the weights b sum to 0.917 and not to 1"));
  tableau = right;
  tableau.computed_order = 3;
  EXPECT_TRUE(says(complaint_of_stepper(tableau), "its order is said to be 3 but is 2"));
  tableau = right;
  tableau.embedded_order = 2;
  EXPECT_TRUE(says(complaint_of_stepper(tableau), "its embedded order is said to be 2 but is 1"));
  tableau = right;
  tableau.c[1] = 0.5L;
  EXPECT_TRUE(says(complaint_of_stepper(tableau), "row 2 of a sums to 1"));
  tableau = right;
  tableau.a.pop_back();
  EXPECT_TRUE(says(complaint_of_stepper(tableau), "a has 3 entries"));
}

// What the compiler says of methods of one's own, as constants: static_assert refuses them in ExplicitRk.
struct Heun {
  static constexpr int order = 2, error_order = 2;
  static constexpr ButcherTableau<2> tableau{
      .a = {{{}, {1}}}, .b = {0.5L, 0.5L}, .b_err = {-0.5L, 0.5L}, .c = {0, 1}};
};
struct LighterHeun : Heun {
  static constexpr ButcherTableau<2> tableau{.a = {{{}, {1}}}, .b = {0.5L, 0.417L}, .b_err = {}, .c = {0, 1}};
};
struct ProudHeun : Heun {
  static constexpr int order = 3;
};
struct ProudEstimate : Heun {
  static constexpr int error_order = 3;
};
static_assert(CheckedTableau<Heun>::value && CheckedTableau<tableaux::Dop853>::value);
static_assert(!detail::is_consistent<LighterHeun>() && detail::is_consistent<Heun>());
static_assert(!detail::reaches_its_order<ProudHeun>() && !detail::reaches_its_error_order<ProudEstimate>());

}  // namespace
}  // namespace hmax
