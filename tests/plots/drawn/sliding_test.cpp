#include "plots/drawn/sliding.hpp"

#include <algorithm>
#include <limits>
#include <regex>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// A square region, and one point that leaves it at h = 1, another that stays.
SlidingPicture square() {
  return {
      .title = "A & B",
      .region = {{{-2, -2}, {0, -2}, {0, 2}, {-2, 2}}},
      .re = {-4, 1},
      .im = {-3, 3},
      .spectra = {{"leaves", {{-2, 0, 1}}}, {"stays", {{-0.1, 0, std::numeric_limits<double>::infinity()}}}},
      .end = 2};
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(SlidingSpectrum, TurnsRedWhenItsStepIsTooLong) {
  const std::string svg = sliding_svg(square());
  // Half of the way, which takes nine tenths of a round; the point and its sample in the list.
  EXPECT_EQ(count(svg, "#d00000\" keyTimes=\"0;0.4500\""), 2U);
  EXPECT_NE(svg.find(">unbounded<"), std::string::npos);
  EXPECT_NE(svg.find(">1 s<"), std::string::npos);
  EXPECT_NE(svg.find("A &amp; B"), std::string::npos);
  EXPECT_NE(svg.find("h = 2.00 s"), std::string::npos);
}

TEST(SlidingSpectrum, EveryAnimationHasAsManyTimesAsValues) {
  const std::string svg = sliding_svg(square());
  const std::regex animation("values=\"([^\"]*)\" keyTimes=\"([^\"]*)\"");
  int seen = 0;
  for (std::sregex_iterator it(svg.begin(), svg.end(), animation), end; it != end; ++it, ++seen) {
    const std::string values = (*it)[1], times = (*it)[2];
    EXPECT_EQ(std::ranges::count(values, ';'), std::ranges::count(times, ';')) << it->str();
    EXPECT_EQ(times.substr(0, 2), "0;");
  }
  EXPECT_GT(seen, 50);
}

TEST(SlidingSpectrum, StandsWithExactlyOneStepWrittenWhereNothingMoves) {
  EXPECT_EQ(count(sliding_svg(square()), "visibility=\"visible\""), 1U);
}

TEST(SlidingSpectrum, FramesShowWhoIsOutside) {
  const std::string inside = sliding_frames_svg(square(), {0.5}),
                    outside = sliding_frames_svg(square(), {1.5});
  // One sample in the key.
  EXPECT_EQ(count(inside, "fill=\"#d00000\""), 1U);
  EXPECT_EQ(count(outside, "fill=\"#d00000\""), 2U);
  EXPECT_EQ(inside.find("<animate"), std::string::npos);
  EXPECT_EQ(count(sliding_frames_svg(square(), {0.1, 1, 2}), "<clipPath"), 3U);
}

}  // namespace
}  // namespace hmax
