#include "plots/drawn/sliding.hpp"

#include <algorithm>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/plots/text_search.hpp"

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

TEST(SlidingSpectrum, NamesItsAxesInTheMiddle) {
  const std::string svg = sliding_svg(square());
  std::smatch frame, re, im;
  ASSERT_TRUE(std::regex_search(
      svg, frame,
      std::regex(
          "<clipPath id=\"plane\"><rect x=\"([0-9.]+)\" y=\"([0-9.]+)\" width=\"([0-9.]+)\" height=\"([0-9.]+)\"")));
  ASSERT_TRUE(std::regex_search(
      svg, im, std::regex("translate\\(16 ([0-9.]+)\\) rotate\\(-90\\)\" text-anchor=\"middle\">Im")));
  ASSERT_TRUE(std::regex_search(svg, re, std::regex("<text x=\"([0-9.]+)\"[^>]*>Re h")));
  EXPECT_NEAR(std::stod(im[1]), std::stod(frame[2]) + std::stod(frame[4]) / 2, 0.06);
  EXPECT_NEAR(std::stod(re[1]), std::stod(frame[1]) + std::stod(frame[3]) / 2, 0.06);
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

TEST(SlidingSpectrum, ShowsEachOfManySpectra) {
  SlidingPicture picture = square();
  picture.spectra = {{"one", {{-2, 0, 1}, {-1, 1, 9}}}, {"two", {{-1, 0, 0.5}}}, {"three", {{-3, 0, 0.25}}}};
  const std::string moving = sliding_svg(picture);
  // A ray and a moving point for each of four, beside the points a list of three and what outside looks like,
  // and on the bar three largest steps.
  EXPECT_EQ(count(moving, "stroke-dasharray"), 4U);
  EXPECT_EQ(count(moving, "attributeName=\"cx\""), 4U);
  EXPECT_EQ(count(moving, "r=\"6\""), 4U + 3 + 1);
  EXPECT_EQ(count(moving, "v14\""), 3U);
  for (const char* text : {">one<", ">two<", ">three<", ">1 s<", ">0.5 s<", ">0.25 s<"})
    EXPECT_EQ(count(moving, text), 1U) << text;
  const std::string frames = sliding_frames_svg(picture, {0.1, 0.2});
  EXPECT_EQ(count(frames, "r=\"4.5\""), 2U * 4);
  // The key stands below in one row, each name behind the one before it.
  std::vector<double> places;
  const std::regex sample("<circle cx=\"([0-9.]+)\" cy=\"[0-9.]+\" r=\"5\"");
  for (std::sregex_iterator at(frames.begin(), frames.end(), sample), none; at != none; ++at)
    places.push_back(std::stod(at->str(1)));
  ASSERT_EQ(places.size(), 3U + 1);
  EXPECT_EQ(places[0], 40);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_GT(places[k + 1], places[k] + 11 + 6 * static_cast<double>(picture.spectra[k].label.size())) << k;
}

TEST(SlidingSpectrum, ShowsThePlaneWithEqualScalesAndEachPointWhereItIs) {
  // A frame of 900 - 20 - 34 pixels in width shows re from -4 to 1 and, as high as it may be, im from -3
  // to 3.
  SlidingPicture picture = square();
  picture.spectra = {{"one", {{-2, 1, 9}, {-1, -0.5, 9}, {0, 0, 9}}}};
  const double wide = 900 - 20 - 34, high = 1.2 * wide, left = 40, top = 68;
  const auto expect_points = [&](const std::string& svg, double h) {
    const std::regex circle("<circle cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\" r=\"4.5\"");
    std::size_t i = 0;
    for (std::sregex_iterator at(svg.begin(), svg.end(), circle), none; at != none; ++at, ++i) {
      const SlidingPoint& p = picture.spectra[0].points.at(i);
      EXPECT_NEAR(std::stod(at->str(1)), left + wide * (h * p.re + 4) / 5, 0.06) << i;
      EXPECT_NEAR(std::stod(at->str(2)), top + high * (3 - h * p.im) / 6, 0.06) << i;
    }
    EXPECT_EQ(i, 3U);
  };
  for (const double h : {0.5, 1.5}) expect_points(sliding_frames_svg(picture, {h}), h);
  // The corners of the region.
  EXPECT_NE(sliding_frames_svg(picture, {1})
                .find(fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", left + wide * 2 / 5, top + high * 5 / 6,
                                  left + wide * 4 / 5, top + high * 5 / 6)),
            std::string::npos);
  // In a plane that is too low for it, re is wider on both sides: a point in the middle stays there.
  picture.im = {-0.1, 0.1};
  picture.spectra = {{"one", {{-1.5, 0, 9}}}};
  const std::string low = sliding_frames_svg(picture, {1, 1});
  EXPECT_NE(low.find(fmt::format("cx=\"{:.1f}\"", 40 + (440 - 34) / 2.0)), std::string::npos) << low;
}

}  // namespace
}  // namespace hmax
