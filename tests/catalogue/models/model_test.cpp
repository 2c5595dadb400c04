#include "catalogue/models/model.hpp"

#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
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

}  // namespace
}  // namespace hmax
