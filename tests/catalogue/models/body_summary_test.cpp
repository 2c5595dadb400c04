/// What a body was taken to be, and which values are slips in units.
#include "catalogue/models/body_summary.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

BodySummary made(const std::string& id, std::vector<std::pair<std::string, double>> set = {}) {
  ProblemSettings settings;
  settings.parameters = std::move(set);
  return summary_of(*make_problem(id, settings).body);
}

TEST(BodySummary, IsThatOfABox) {
  const BodySummary beam = made("fem_green@beam:n=2,length=0.2,width=0.04,height=0.05");
  EXPECT_NEAR(beam.size.prod(), 0.2 * 0.04 * 0.05, 1e-12);
  EXPECT_NEAR(beam.mass, 1060 * 0.2 * 0.04 * 0.05, 1e-9);
  EXPECT_EQ(beam.young[0], 5500);
  EXPECT_GT(beam.held, 0);
  EXPECT_LT(beam.held, beam.points);
  EXPECT_TRUE(unusual_values(beam).empty());
}

TEST(BodySummary, HasTheDensityThatAMassMakes) {
  const BodySummary beam = made("fem_green@beam:n=2,length=0.2,width=0.04,height=0.05", {{"mass", 0.8}});
  EXPECT_NEAR(beam.mass, 0.8, 1e-12);
  EXPECT_NEAR(beam.density[0], 2000, 1e-9);
}

TEST(BodySummary, SpringsHaveAQuarterForNu) { EXPECT_EQ(made("mass_spring@cube:n=2").poisson[1], 0.25); }

TEST(BodySummary, SpringsOfOneStiffnessHaveNoModulus) {
  EXPECT_TRUE(in_words(made("mass_spring@cube:n=2")).starts_with("E 5500 Pa, nu 0.25, "));
  EXPECT_TRUE(in_words(made("mass_spring@cube:n=2", {{"k", 120}})).starts_with("springs of 120 N/m, "));
}

TEST(BodySummary, SlipsInUnitsAreUnusual) {
  const auto sentences = [](std::vector<std::pair<std::string, double>> set) {
    return unusual_values(made("fem_green@cube:n=2", std::move(set)));
  };
  ASSERT_EQ(sentences({{"E", 5.5}}).size(), 1U);
  EXPECT_EQ(sentences({{"E", 5.5}})[0], "E is 5.5 Pa, usual are 50 to 5e+11 Pa; 5.5 kPa are 5500 Pa");
  EXPECT_TRUE(sentences({{"E", 2.1e11}, {"rho", 7850}}).empty()) << "an instrument of steel";
  EXPECT_EQ(sentences({{"rho", 1.06}}).size(), 1U);
  EXPECT_EQ(sentences({{"mass", 1000}}).size(), 1U) << "grams";
  EXPECT_EQ(sentences({{"g", 9810}}).size(), 1U);
  const auto of_load = [](const std::string& load, std::vector<std::pair<std::string, double>> set) {
    const std::vector<std::string> told =
        unusual_values(made("fem_green/" + load + "@cube:n=2", std::move(set)));
    return told.size() == 1 ? told.front() : std::to_string(told.size()) + " sentences";
  };
  EXPECT_EQ(of_load("tool", {{"depth", 10}}),
            "depth is 10 m, more than the longest side of the body (0.1 m); give metres: 10 mm are 0.01 m");
  EXPECT_TRUE(of_load("tool", {{"tool_radius", 10}, {"depth", 0.01}}).starts_with("tool_radius is 10 m"));
  EXPECT_EQ(
      of_load("press", {{"force", 500}}),
      "force is 500 N, more than E times the square of its longest side (55 N); give newtons: 500 mN are 0.5 N");
  EXPECT_EQ(of_load("press", {{"force", 0.5}}), "0 sentences");
  EXPECT_EQ(unusual_values(made("fem_green@cube:n=2,edge=100")).size(), 1U) << "millimetres taken for metres";
  // A factor of E taken for pascals.
  EXPECT_TRUE(unusual_values(made("fem_green@cube:n=2", {{"skin", 1000}})).empty());
  const auto skin = unusual_values(made("fem_green@cube:n=2", {{"skin", 1e5}}));
  ASSERT_EQ(skin.size(), 1U);
  EXPECT_TRUE(says(skin.front(), "skin is a factor of E"));
  const auto heavy = unusual_values(made("fem_green@cube:n=2", {{"mass", 1000}}));
  ASSERT_EQ(heavy.size(), 1U);
  EXPECT_TRUE(says(heavy.front(), "--unit"));
}

TEST(BodySummary, GreensStrainSaysHowFarItCanBeCompressed) {
  // Nominal stress E s (s^2 - 1) / 2 of a bar at the stretch s = 1 / sqrt(3), and rho g L.
  const double s = 1 / std::sqrt(3.0), most = 3000 * s * (1 - s * s) / 2, weight = 1060 * 9.81 * 0.1;
  const BodySummary soft = made("fem_green@cube:n=2", {{"E", 3000}});
  EXPECT_NEAR(soft.most_compression, most, 1e-9);
  EXPECT_NEAR(soft.weight_compression, weight, 1e-9);
  ASSERT_EQ(unusual_values(soft).size(), 1U);
  EXPECT_EQ(unusual_values(soft)[0],
            "this model carries at most 577.4 Pa of compression; the weight above the support "
            "needs 1040 Pa; --model fem_neo_hookean restores inverted elements");
  EXPECT_TRUE(unusual_values(made("fem_green@cube:n=2", {{"E", 6000}})).empty()) << "it carries its weight";
  EXPECT_TRUE(unusual_values(made("fem_green@cube:n=2", {{"E", 3000}, {"axis", -3}})).empty()) << "it hangs";
  EXPECT_TRUE(unusual_values(made("fem_neo_hookean@cube:n=2", {{"E", 3000}})).empty());
}

TEST(BodySummary, WarnsWhereMassScalingMakesAnotherBody) {
  const auto told = [](double step) {
    return unusual_values(made("fem_green@cube:n=2", {{"mass_step", step}}));
  };
  const BodySummary heavy = made("fem_green@cube:n=2", {{"mass_step", 0.05}});
  const double share = heavy.added_mass / heavy.mass;
  ASSERT_GT(share, 1) << "more is added than there was";
  ASSERT_EQ(told(0.05).size(), 1U);
  EXPECT_TRUE(says(told(0.05)[0], "mass_step adds "));
  EXPECT_TRUE(says(told(0.05)[0], "to a body of 1.06 kg"));
  EXPECT_TRUE(told(1e-4).empty()) << "nothing is added";
  // Four times the mass: half the frequency.
  EXPECT_NEAR(slowed_by(3), 0.5, 1e-15);
}

/// The tip of a cantilever under its weight sags by rho g L^4 / (8 E I), whatever nu is.
TEST(BodySummary, WarnsOfLockingWhereLinearTetrahedraLoseAQuarterOfTheSag) {
  EXPECT_TRUE(unusual_values(made("fem_green@beam:n=2", {{"nu", 0.45}})).empty());
  EXPECT_TRUE(unusual_values(made("mass_spring@beam:n=2")).empty());
  for (const double nu : {0.48, 0.499}) {
    const auto told = unusual_values(made("fem_green@beam:n=2", {{"nu", nu}}));
    ASSERT_EQ(told.size(), 1U) << nu;
    EXPECT_TRUE(says(told[0], "volumetric locking"));
    EXPECT_TRUE(says(told[0], "--model fem_nodal_pressure"));
    EXPECT_TRUE(unusual_values(made("fem_nodal_pressure@beam:n=2", {{"nu", nu}})).empty()) << nu;
  }
  const auto sag = [](double nu) {
    ProblemSettings settings;
    settings.parameters = {{"nu", nu}, {"g", 0.3}};
    const Problem problem = make_problem("fem_cauchy@beam:n=8", settings);
    return largest_displacement(found_equilibrium(problem, 1, {}, [] { return 0.0; }).q);
  };
  const double soft = sag(0.3);
  EXPECT_LT(sag(locking_from) / soft, 0.76);
  EXPECT_GT(sag(0.45) / soft, 0.85);
}

}  // namespace
}  // namespace hmax
