#include "problems/oscillator/liver_problems.hpp"

#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "problems/oscillator/liver_materials.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(LiverMaterials, DampingGrowsWithStiffnessAndWomenAreLighter) {
  ASSERT_EQ(liver_materials().size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& material = liver_materials()[i];
    EXPECT_LT(material.mass_low, material.mass_high);
    if (i % 3 > 0) {
      EXPECT_GT(material.stiffness, liver_materials()[i - 1].stiffness);
      EXPECT_GT(material.damping, liver_materials()[i - 1].damping);
    }
  }
  EXPECT_EQ(liver_material("male_normal").stiffness, 5.3);
  EXPECT_EQ(liver_material("female_slim").damping, 4.5);
}

TEST(LiverMaterials, SuffixChoosesTheEndOfTheMassRange) {
  OscillatorParameters base;
  EXPECT_DOUBLE_EQ(with_material(base, "male_normal").m, 1.45);
  EXPECT_EQ(with_material(base, "female_fat:light").m, 1.2);
  EXPECT_EQ(with_material(base, "female_fat:heavy").m, 1.4);
  base.k3 = 3;
  base.P = 4;
  const auto p = with_material(base, "female_fat");
  EXPECT_EQ(p.c, 8);
  EXPECT_EQ(p.k1, 6.6);
  EXPECT_EQ(p.k3, 3);
  EXPECT_EQ(p.P, 4);
}

TEST(LiverMaterials, UnknownNamesAreRefusedWithTheKnownOnes) {
  EXPECT_TRUE(says(error_of<std::invalid_argument>([] { liver_material("male_tall"); }), "female_normal"));
  EXPECT_TRUE(
      says(error_of<std::invalid_argument>([] { liver_material("male_fat:huge"); }), ":light or :heavy"));
  EXPECT_TRUE(says(error_of<std::invalid_argument>([] { with_material({}, ""); }), "no liver material ''"));
}

TEST(LiverProblems, TheForcedProblemIsThePublishedFullModel) {
  const auto& problem = liver_problem("liver_forced");
  EXPECT_EQ(problem.parameters, (OscillatorParameters{1.45, 2, 0.7, 0.8, 0.5, 0.5}));
  EXPECT_EQ(problem.y0, Eigen::Vector2d(0.5, 1));
  EXPECT_EQ(problem.t_end, 100);
}

TEST(LiverProblems, CasesOneAndTwoAreUnforcedAndCaseOneIsLinear) {
  EXPECT_EQ(liver_problem("liver_linear").parameters.k3, 0);
  EXPECT_EQ(liver_problem("liver_linear").parameters.P, 0);
  EXPECT_EQ(liver_problem("liver_cubic").parameters.P, 0);
  EXPECT_NE(liver_problem("liver_cubic").parameters.k3, 0);
  EXPECT_TRUE(says(error_of<std::invalid_argument>([] { liver_problem("liver"); }), "liver_benchmark"));
}

TEST(LiverProblems, EveryProblemAndEveryMemberOfAFamilyIsAValidOscillator) {
  for (const auto& problem : liver_problems()) EXPECT_NO_THROW(Oscillator{problem.parameters});
  std::set<std::string_view> ids;
  for (const auto& family : liver_families()) {
    EXPECT_TRUE(ids.insert(family.id).second) << family.id;
    EXPECT_GE(family.members.size(), 2u);
    for (const auto& member : family.members) EXPECT_NO_THROW(Oscillator{member.parameters}) << member.label;
  }
  EXPECT_TRUE(says(error_of<std::invalid_argument>([] { liver_family("mass"); }), "linear_mass"));
}

TEST(LiverProblems, FamiliesHoldThePublishedValuesAndLabelThem) {
  EXPECT_EQ(liver_family("linear_mass").members[0].label, "m = 1.2 kg");
  EXPECT_EQ(liver_family("cubic_damping").members[0].label, "c = -0.2 N s/m");
  EXPECT_EQ(liver_family("cubic_damping").members[3].parameters.c, 10);
  EXPECT_EQ(liver_family("cubic_damping").members[3].label, "c = 10 N s/m");
  EXPECT_EQ(liver_family("timing").members[0].parameters, liver_problem("liver_forced").parameters);
  for (const auto& [label, p] : liver_family("linear_critical").members)
    EXPECT_NEAR(p.c / (2 * std::sqrt(p.k1 * p.m)), 1, 1e-15) << label;
}

}  // namespace
}  // namespace hmax
