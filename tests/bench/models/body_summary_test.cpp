/// What a body was taken to be, and which values are slips in units.
#include "bench/models/body_summary.hpp"

#include <gtest/gtest.h>

#include "bench/catalogue/catalogue.hpp"

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

TEST(BodySummary, SlipsInUnitsAreUnusual) {
  const auto sentences = [](std::vector<std::pair<std::string, double>> set) {
    return unusual_values(made("fem_green@cube:n=2", std::move(set)));
  };
  ASSERT_EQ(sentences({{"E", 5.5}}).size(), 1U);
  EXPECT_EQ(sentences({{"E", 5.5}})[0], "E is 5.5 Pa, and tissue has 50 to 5e+10 Pa; 5.5 kPa are 5500 Pa");
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
  EXPECT_NE(skin.front().find("skin is a factor of E"), std::string::npos) << skin.front();
  const auto heavy = unusual_values(made("fem_green@cube:n=2", {{"mass", 1000}}));
  ASSERT_EQ(heavy.size(), 1U);
  EXPECT_NE(heavy.front().find("--unit"), std::string::npos) << heavy.front();
}

}  // namespace
}  // namespace hmax
