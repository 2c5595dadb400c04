#include "advice/remaking.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "catalogue/models/tissue_problem.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

double parameter(const Problem& problem, const std::string& name) {
  for (const auto& [key, value] : problem.parameters)
    if (key == name) return value;
  return std::numeric_limits<double>::quiet_NaN();
}

TEST(Remaking, OtherParametersReplaceThoseThatWereSet) {
  const Remaking make = remaking("liver_forced", {.parameters = {{"c", 3}, {"m", 2}}});
  const Problem changed = make.with({{"c", 7}});
  EXPECT_EQ(parameter(changed, "c"), 7);
  EXPECT_EQ(parameter(changed, "m"), 2);
  EXPECT_FALSE(make.coarser);
  EXPECT_FALSE(make.mended);
}

TEST(Remaking, ABodyIsMadeOnACoarserAndOnAMendedMesh) {
  const Remaking make = remaking(tissue_id("fem_green", "ball:n=8", "press"), {.parameters = {{"E", 4000}}});
  ASSERT_TRUE(make.coarser);
  const Problem coarser = make.coarser(), same = make.with({});
  EXPECT_LT(coarser.body->mesh().tetrahedron_count(), same.body->mesh().tetrahedron_count() / 4);
  EXPECT_EQ(parameter(coarser, "E"), 4000);
  EXPECT_EQ(coarser.id, "fem_green/press@ball:n=4");
  ASSERT_TRUE(make.mended);
  EXPECT_EQ(make.mended(2).id, "fem_green/press@ball:n=8:mend=2");
}

}  // namespace
}  // namespace hmax
