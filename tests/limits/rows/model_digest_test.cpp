#include "limits/rows/model_digest.hpp"

#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"

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

}  // namespace
}  // namespace hmax
