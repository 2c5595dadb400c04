#include "analysis/spectrum/entry_rounding.hpp"

#include <gtest/gtest.h>

namespace hmax {
namespace {

AnyMatrix of(std::initializer_list<double> entries) {
  Eigen::MatrixXd matrix(1, static_cast<Eigen::Index>(entries.size()));
  std::copy(entries.begin(), entries.end(), matrix.data());
  return matrix;
}

TEST(EntryRounding, IsHalfOfTheLastOfTheMostDigits) {
  EXPECT_DOUBLE_EQ(entry_rounding(of({0.33333333, -2, 0})), 0.5e-7);
  EXPECT_DOUBLE_EQ(entry_rounding(of({1234.56789012, 0.5})), 0.5e-11);
  EXPECT_DOUBLE_EQ(entry_rounding(of({1.23457e20, 3})), 0.5e-5);
}

TEST(EntryRounding, IsNothingOfShortNumbersAndOfFullDoubles) {
  EXPECT_EQ(entry_rounding(of({2, -1, 1e5, 0.25})), 0) << "they may be exact";
  EXPECT_EQ(entry_rounding(of({1.0 / 3, 0.33333333})), 0);
  EXPECT_EQ(entry_rounding(of({})), 0);
}

}  // namespace
}  // namespace hmax
