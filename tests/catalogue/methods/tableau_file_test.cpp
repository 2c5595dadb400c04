#include "catalogue/methods/tableau_file.hpp"

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

RuntimeTableau from(std::string_view text) { return tableau_from(parse_toml(text, "my.toml")); }

void expect_complaint(std::string_view text, std::string_view start, std::string_view part) {
  const std::string message = error_of<InputError>([&] { from(text); });
  EXPECT_TRUE(message.starts_with(start)) << message;
  EXPECT_TRUE(says(message, part));
}

constexpr std::string_view dormand_prince = R"(
name = "my_dp"
a = [[],
     ["1/5"],
     ["3/40", "9/40"],
     ["44/45", "-56/15", "32/9"],
     ["19372/6561", "-25360/2187", "64448/6561", "-212/729"],
     ["9017/3168", "-355/33", "46732/5247", "49/176", "-5103/18656"],
     ["35/384", 0, "500/1113", "125/192", "-2187/6784", "11/84"]]
b = ["35/384", 0, "500/1113", "125/192", "-2187/6784", "11/84", 0]
b_hat = ["5179/57600", 0, "7571/16695", "393/640", "-92097/339200", "187/2100", "1/40"]
c = [0, 0.2, 0.3, 0.8, "8/9", 1, 1]
)";

TEST(TableauFile, ReadsDormandPrinceWithItsOrders) {
  const auto tableau = from(dormand_prince);
  EXPECT_EQ(tableau.name, "my_dp");
  EXPECT_EQ(tableau.stages(), 7u);
  EXPECT_EQ(tableau.computed_order, 5);
  EXPECT_EQ(tableau.embedded_order, 4);
  EXPECT_TRUE(tableau.fsal);
  EXPECT_EQ(tableau.a[3 * 7 + 1], -56 / 15.0L);
  const auto& known = tableaux::DormandPrince54::tableau;
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NEAR(static_cast<double>(tableau.b_err[i] - known.b_err[i]), 0, 1e-18);
    EXPECT_NEAR(static_cast<double>(tableau.c[i] - known.c[i]), 0, 1e-18);
  }
}

TEST(TableauFile, AcceptsEveryWayOfWritingANumber) {
  const auto tableau = from("a = [[0, 0], [\"1.0D0\", 0]]\nb = [\" 1 / 2 \", \"+0.5\"]\n");
  EXPECT_EQ(tableau.name, "my");
  EXPECT_EQ(tableau.computed_order, 2);
  EXPECT_EQ(tableau.embedded_order, 0);
  EXPECT_FALSE(tableau.has_error());
  EXPECT_FALSE(tableau.fsal);
  EXPECT_EQ(tableau.c, (std::vector<long double>{0, 1}));
}

TEST(TableauFile, KeepsEveryDigitOfAQuotedDecimal) {
  const auto tableau = from("a = [[], [\"0.3333333333333333333333\"]]\nb = [0, 1]");
  EXPECT_NEAR(static_cast<double>(tableau.a[2] - 1 / 3.0L), 0, 1e-19);
}

TEST(TableauFile, ComputesOrdersThatAreLowerThanHoped) {
  EXPECT_EQ(
      from("a = [[], [0.5], [0, 0.5], [0, 0, 1]]\nb = [\"1/6\", \"1/3\", \"1/3\", \"1/6\"]").computed_order,
      4);
  EXPECT_EQ(
      from("a = [[], [0.5], [0, 0.4], [0, 0, 1]]\nb = [\"1/6\", \"1/3\", \"1/3\", \"1/6\"]").computed_order,
      1);
}

TEST(TableauFile, NamesTheRowWhoseSumIsNotItsNode) {
  expect_complaint("a = [[],\n [0.5],\n [-1, 2]]\nb = [\"1/6\", \"2/3\", \"1/6\"]\nc = [0, 0.5, 0.9]",
                   "my.toml:3: ", "row 3 of a sums to 1 but entry 3 of c is 0.9");
}

TEST(TableauFile, RefusesInconsistentWeights) {
  expect_complaint("a = [[], [1]]\nb = [0.5, 0.4]", "my.toml:2: ", "the weights b sum to 0.9 and not to 1");
  expect_complaint("a = [[], [1]]\nb = [0.5, 0.5]\nb_hat = [1, 1]",
                   "my.toml:3: ", "the weights b_hat sum to 2");
  expect_complaint("a = [[], [1]]\nb = [0.5, 0.5]\nb_hat = [0.5, 0.5]", "my.toml:3: ", "b_hat equals b");
}

TEST(TableauFile, RefusesImplicitTableaux) {
  expect_complaint("a = [[], [0.5, 0.5]]\nb = [0.5, 0.5]",
                   "my.toml:1: ", "row 2 of a has a nonzero entry in column 2");
  expect_complaint("a = [[1]]\nb = [1]", "my.toml:1: ", "only explicit tableaux are accepted");
}

TEST(TableauFile, RefusesWrongShapes) {
  expect_complaint("b = [1]", "my.toml: ", "'a' is missing");
  expect_complaint("a = [[]]", "my.toml: ", "'b' is missing");
  expect_complaint("a = [[1]]\nb = [0, 1]", "my.toml:1: ", "a has 1 rows but b has 2 weights");
  expect_complaint("a = [[], [1, 0, 0]]\nb = [0, 1]", "my.toml:1: ", "row 2 of a has 3 entries");
  expect_complaint("a = [0, [1]]\nb = [0, 1]", "my.toml:1: ", "row 1 of a is not a list");
  expect_complaint("a = 3\nb = [0, 1]", "my.toml:1: ", "'a' must be a list of rows");
  expect_complaint("a = [[]]\nb = 1", "my.toml:2: ", "'b' must be a list");
  expect_complaint("a = []\nb = []", "my.toml:2: ", "b is empty");
  expect_complaint("a = [[], [1]]\nb = [0, 1]\nc = [0]", "my.toml:3: ", "c has 1 entries but b has 2");
  expect_complaint("a = [[], [1]]\nb = [0, 1]\nb_hat = [1]",
                   "my.toml:3: ", "b_hat has 1 entries but b has 2");
}

TEST(TableauFile, RefusesWhatIsNotANumber) {
  expect_complaint("a = [[]]\nb = [\"1/0\"]", "my.toml:2: ", "divides by zero");
  expect_complaint("a = [[]]\nb = [\"1,0\"]", "my.toml:2: ", "1.5 and not 1,5");
  expect_complaint("a = [[]]\nb = [\"one\"]", "my.toml:2: ", "'one' is not a number");
  expect_complaint("a = [[]]\nb = [\"\"]", "my.toml:2: ", "is not a number");
  expect_complaint("a = [[]]\nb = [\"1/\"]", "my.toml:2: ", "is not a number");
  expect_complaint("a = [[]]\nb = [\"1/2/3\"]", "my.toml:2: ", "is not a number");
  expect_complaint("a = [[]]\nb = [\"0x1\"]", "my.toml:2: ", "is not a number");
  expect_complaint("a = [[]]\nb = [true]", "my.toml:2: ", "must be a number");
  expect_complaint("a = [[]]\nb = [nan]", "my.toml:2: ", "not finite");
  expect_complaint("a = [[]]\nb = [inf]", "my.toml:2: ", "not finite");
  expect_complaint("a = [[]]\nb = [\"1e4000\"]", "my.toml:2: ", "not finite");
  expect_complaint("a = [[]]\nb = [\"1e99999\"]", "my.toml:2: ", "outside the range");
}

TEST(TableauFile, RefusesHostileSizes) {
  std::string rows, weights;
  for (int i = 0; i < 41; ++i) {
    rows += "[],";
    weights += "0,";
  }
  expect_complaint("a = [" + rows + "]\nb = [" + weights + "1]", "my.toml:2: ", "more than 40 stages");
  expect_complaint("a = [[]]\nb = [\"" + std::string(1000, '1') + "\"]",
                   "my.toml:2: ", "more than 200 characters");
}

TEST(TableauFile, SurvivesCoefficientsThatOverflowTheOrderConditions) {
  const auto tableau = from("a = [[], [1e300], [0, 1e300], [0, 0, 1e300]]\nb = [1, 0, 0, 0]");
  EXPECT_EQ(tableau.computed_order, 1);
}

TEST(TableauFile, SuggestsTheKeyThatWasMeant) {
  expect_complaint("a = [[]]\nb = [1]\nbhat = [1]",
                   "my.toml:3: ", "unknown key 'bhat'; did you mean 'b_hat'?");
}

TEST(TableauFile, RefusesNamesThatCannotBeStored) {
  expect_complaint("name = \"a b\"\na = [[]]\nb = [1]", "my.toml:1: ", "the name must be");
  expect_complaint("name = 3\na = [[]]\nb = [1]", "my.toml:1: ", "the name must be");
}

}  // namespace
}  // namespace hmax
