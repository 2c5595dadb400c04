#include "results/published/published.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(Published, Table2GoesOnCountingWhereTheSolverBeforeStopped) {
  const Table table = published_table("table_2");
  ASSERT_EQ(table.columns, (std::vector<std::string>{"h [s]", "Euler [s]", "ode45 [s]", "ode23s [s]",
                                                     "ode113 [s]", "ode23t [s]"}));
  EXPECT_EQ(table.values[0], (std::vector<double>{2, 0.6, 0.2, 0.15, 0.05, 0.01, 0.005, 0.0005, 0.00005}));
  for (std::size_t c = 2; c + 1 < table.columns.size(); ++c) {
    EXPECT_NEAR(table.values[c].back(), table.values[c + 1].front(), 0.11) << table.columns[c];
  }
}

TEST(Published, DifferencesDownTable2AreTheMeasurement) {
  const Table costs = differences_per_column(published_table("table_2"));
  ASSERT_EQ(costs.values[0].size(), 8u);
  EXPECT_EQ(costs.values[0].back(), 0.00005);
  const double expected[] = {3.4, 371.75, 368.3, 360.5, 35.4};
  for (std::size_t c = 0; c < 5; ++c) EXPECT_NEAR(costs.values[c + 1].back(), expected[c], 0.001);
  // The clock of the ode45 column ticks every 1/64 s, rounded to 0.0156; its last row has a digit less.
  for (std::size_t r = 0; r < 7; ++r) {
    const double ticks = costs.values[2][r] / 0.0156;
    EXPECT_NEAR(ticks, std::round(ticks), 1e-6) << r;
  }
}

TEST(Published, EveryTableSaysWhatItIs) {
  for (const char* name : {"benchmark_liver", "benchmark_liver_mass", "table_2"}) {
    const Table table = published_table(name);
    ASSERT_FALSE(table.notes.empty());
    EXPECT_EQ(table.notes[0].first, "title");
    EXPECT_FALSE(table.values[0].empty());
  }
  EXPECT_EQ(published_table("benchmark_liver").values[2], (std::vector<double>{4.3, 5.1, 6.6}));
}

TEST(Published, AnUnknownNameListsTheKnownOnes) {
  EXPECT_TRUE(says(error_of<InputError>([&] { published_table("table_3"); }), "table_2"));
  EXPECT_THROW(differences_per_column({}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
