#include "studies/tool_contact.hpp"

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// A box along z from the origin, 2 long and 1 wide, beside triangles of every kind.
TEST(ViewVolume, FindsTrianglesOfWhichAPieceLiesInside) {
  const ViewVolume volume = view_along({0, 0, 0}, {0, 0, 2}, 0.5);
  const auto found = [&](const Eigen::Matrix3d& corners) {
    MeshTriangles one(3, 1);
    one << 0, 1, 2;
    return !triangles_in(volume, corners, one).empty();
  };
  const auto triangle = [](double x0, double y0, double z0, double x1, double y1, double z1, double x2,
                           double y2, double z2) {
    Eigen::Matrix3d corners;
    corners << x0, x1, x2, y0, y1, y2, z0, z1, z2;
    return corners;
  };
  EXPECT_TRUE(found(triangle(0, 0, 1, 0.1, 0, 1, 0, 0.1, 1)));        // inside
  EXPECT_TRUE(found(triangle(0, 0, 1, 5, 0, 1, 5, 1, 1)));            // one corner inside
  EXPECT_TRUE(found(triangle(-9, -9, 1, 9, -9, 1, 0, 20, 1)));        // no corner inside, cut by the volume
  EXPECT_TRUE(found(triangle(-9, 0, 1, 9, 0, 1, 9, 0.01, 1)));        // a sliver through it
  EXPECT_FALSE(found(triangle(0, 0, 3, 0.1, 0, 3, 0, 0.1, 3)));       // beyond
  EXPECT_FALSE(found(triangle(0, 0, -0.1, 0.1, 0, -1, 0, 0.1, -1)));  // behind
  EXPECT_FALSE(found(triangle(2, 0, 1, 0, 2, 1, 2, 2, 1)));           // past a corner, though both boxes meet
}

TEST(ViewSearch, MissesNothingThatTheToolTouches) {
  const ViewSearch search = view_search("liver", "male_normal");
  EXPECT_EQ(search.triangles, 370);
  EXPECT_GT(search.touched, 0);
  EXPECT_EQ(search.missed, 0);
  EXPECT_GE(search.found, search.touched);
  EXPECT_LT(search.found, 60);
  EXPECT_GT(search.seconds, 0);
}

TEST(PenaltyContacts, TradePenetrationForTheStep) {
  const std::vector<PenaltyContact> all = penalty_contacts("phantom", "male_normal", 0.008);
  ASSERT_EQ(all.size(), 4U);
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_LT(all[i].penetration, all[i - 1].penetration);
    EXPECT_GT(all[i].force, all[i - 1].force);
    EXPECT_EQ(all[i].h_rest, all[0].h_rest);
  }
  // The force in equilibrium approaches that of the tissue.
  EXPECT_LT(all[3].force / all[2].force, 1.1);
  EXPECT_LT(all[3].h_pressed, 0.9 * all[3].h_rest);
}

}  // namespace
}  // namespace hmax
