#include "catalogue/methods/problem.hpp"

#include <string>

#include <gtest/gtest.h>

namespace hmax {
namespace {

TEST(UserView, ShowsNothingElseWhereNothingIsSaid) {
  const UserView plain;
  const Eigen::Vector3d y(1, 2, 3);
  EXPECT_EQ(plain.state(y), y);
  EXPECT_EQ(plain.own_state(y), y);
  EXPECT_EQ(plain.in_order(std::vector<std::string>{"x", "v"}), (std::vector<std::string>{"x", "v"}));
  EXPECT_EQ(plain.time(4), 4);
}

TEST(UserView, PutsStatesInTheUsersPlacesAndBack) {
  const UserView shown{.t0 = 10, .direction = -1, .order = {2, 0, 1}};
  const Eigen::Vector3d own(1, 2, 3), users(2, 3, 1);
  EXPECT_EQ(shown.state(own), users);
  EXPECT_EQ(shown.own_state(users), own);
  EXPECT_EQ(shown.in_order(std::vector<std::string>{"a", "b", "c"}),
            (std::vector<std::string>{"b", "c", "a"}));
  EXPECT_EQ(shown.time(4), 6);
  EXPECT_EQ(shown.own_time(6), 4);
}

}  // namespace
}  // namespace hmax
