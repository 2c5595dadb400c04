#include "catalogue/models/model.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "problems/tissue/body.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(Model, EveryParameterOfOscillatorsAndBodiesHasAUnit) {
  const Problem oscillator = make_problem("liver_forced", {});
  EXPECT_EQ(with_unit(oscillator, "m"), "m [kg]");
  EXPECT_EQ(with_unit(oscillator, "w"), "w [rad/s]");
  for (const auto& [name, value] : oscillator.parameters)
    EXPECT_FALSE(says(with_unit(oscillator, name), "[1]")) << name;
  const Problem body = make_problem("fem_green@phantom", {});
  EXPECT_EQ(with_unit(body, "E"), "E [Pa]");
  EXPECT_EQ(with_unit(body, "E:tumour"), "E:tumour [Pa]");
  EXPECT_EQ(with_unit(body, "nu"), "nu [1]");
  EXPECT_EQ(with_unit(body, "tool_stiffness"), "tool_stiffness [Pa/m^1.5]");
  EXPECT_EQ(with_unit(make_problem("van_der_pol", {}), "mu"), "mu");
}

TEST(Model, OfEachKindIsToldByWhatItIsMadeOf) {
  EXPECT_EQ(make_problem("liver_forced").kind(), ModelKind::oscillator);
  EXPECT_EQ(make_problem("van_der_pol").kind(), ModelKind::equations);
  EXPECT_EQ(make_problem("fem_green@cube:n=1").kind(), ModelKind::body);
  EXPECT_EQ(linearity_of(make_problem("fem_cauchy@cube:n=1")), Linearity::linear);
  EXPECT_EQ(linearity_of(make_problem("fem_green@cube:n=1")), Linearity::nonlinear);
  EXPECT_EQ(linearity_of(make_problem("liver_linear")), Linearity::linear);
}

TEST(Model, ThatIsNoBodyIsRefusedWithWhatItMeans) {
  const Problem body = make_problem("fem_green@cube:n=1");
  EXPECT_EQ(&require_body(body, ""), body.body.get());
  try {
    require_body(make_problem("liver_forced"), "so it has no modes; name a mesh");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "liver_forced is no body on a mesh, so it has no modes; name a mesh");
  }
}

TEST(Model, ChangesByTheLargestDisplacementOfAPointOrTheLargestState) {
  const Problem body = make_problem("fem_green@cube:n=1");
  Eigen::VectorXd y = Eigen::VectorXd::Zero(body.y0.size());
  EXPECT_EQ(unknowns_of(body), y.size() / 2);
  y.head(3) << 3, 0, 4;
  y[unknowns_of(body)] = 1000;  // a velocity
  EXPECT_EQ(largest_change(body, y), 5);
  const Problem two = make_problem("van_der_pol");
  EXPECT_EQ(unknowns_of(two), 2);
  EXPECT_EQ(largest_change(two, Eigen::Vector2d(1, -7)), 7);
}

TEST(Model, NamesStatesWithTheirUnitsWhereTheyAreKnown) {
  EXPECT_EQ(states_with_units(make_problem("liver_forced")), (std::vector<std::string>{"x [m]", "v [m/s]"}));
  EXPECT_EQ(states_with_units(make_problem("van_der_pol")), (std::vector<std::string>{"x", "v"}));
}

TEST(Model, IsSharedByThreadsOrMadeOnceMore) {
  const Problem body = make_problem("fem_green@cube:n=1");
  EXPECT_EQ(copy_for_thread(body).body, body.body);
  Problem called = make_problem("van_der_pol");
  EXPECT_TRUE(can_be_copied(called));
  EXPECT_EQ(copy_for_thread(called).id, called.id);
  called.again = nullptr;
  EXPECT_FALSE(can_be_copied(called));
}

TEST(Model, MovesThroughAWholePeriodOfItsLoad) {
  const double w = std::get<Oscillator>(make_problem("liver_forced").system).parameters().w;
  EXPECT_DOUBLE_EQ(*period_of_load(make_problem("liver_forced")), 2 * M_PI / w);
  EXPECT_FALSE(period_of_load(make_problem("fem_green@cube:n=1")));
  EXPECT_TRUE(has_moving_load(make_problem("fem_green/breathing@cube:n=1")));
  EXPECT_FALSE(has_moving_load(make_problem("liver_forced"))) << "it is no load of a body";
  EXPECT_TRUE(is_driven(make_problem("liver_forced")));
}

}  // namespace
}  // namespace hmax
