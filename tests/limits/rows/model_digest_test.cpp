#include "limits/rows/model_digest.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

TEST(ModelDigest, TellsModelsApartAndNothingElse) {
  const auto digest = [](const std::string& id, std::vector<std::pair<std::string, double>> parameters) {
    return model_digest(make_problem(id, {.parameters = std::move(parameters)}));
  };
  EXPECT_EQ(digest("liver_forced", {}), digest("liver_forced", {}));
  EXPECT_NE(digest("liver_forced", {}), digest("liver_forced", {{"k3", 1.25}}));
  EXPECT_NE(digest("liver_forced", {}), digest("liver_forced", {{"P", 1.25}}));
  EXPECT_EQ(digest("van_der_pol", {}), digest("van_der_pol", {}));
  const std::string body = "fem_green@cube:n=2";
  EXPECT_EQ(digest(body, {}), digest(body, {}));
  EXPECT_NE(digest(body, {}), digest("fem_green@cube:n=3", {}));
  EXPECT_NE(digest(body, {}), digest(body, {{"rho", 1001}}));
  EXPECT_NE(digest(body, {}), digest(body, {{"E", 3001}}));
}

TEST(ModelDigest, TellsModelsOfLargeAndSmallStatesApart) {
  const Scratch scratch;
  const auto digest = [&](const char* start, const char* gap) {
    write_text(scratch / "stop.toml",
               fmt::format("[equations]\nx = \"v\"\nv = \"-x - 9*min(max(0, abs(x) - {0}), "
                           "{0})/{0}\"\n[initial]\nx = {1}\nv = 0\n",
                           gap, start));
    return model_digest(make_problem(scratch / "stop.toml"));
  };
  EXPECT_NE(digest("1e5", "2e5"), digest("1e5", "3e5"));
  EXPECT_NE(digest("1e-9", "2e-9"), digest("1e-9", "3e-9"));
  EXPECT_EQ(digest("1e5", "2e5"), digest("1e5", "2e5"));
}

}  // namespace
}  // namespace hmax
