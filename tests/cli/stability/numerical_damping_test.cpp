/// hmax stability numerical-damping of bodies: its document and its errors.
#include <cmath>
#include <complex>

#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

const std::string numerical_damping = "stability numerical-damping --h 0.01 ";

TEST(NumericalDampingOfABody, IsThatOfEachOfItsSlowestModes) {
  const nlohmann::json document = Shell().json(
      numerical_damping +
      "--methods implicit_euler,vbd:iterations=3,substeps=2 --mesh cube:n=2 --model fem_cauchy --set g=0");
  EXPECT_EQ(document["model"], "fem_cauchy@cube:n=2");
  EXPECT_EQ(document["state"], "rest");
  ASSERT_EQ(document["rows"].size(), 2U);
  EXPECT_EQ(document["rows"][1]["options"]["substeps"], 2);
  const nlohmann::json& row = document["rows"][0];
  EXPECT_EQ(row["method"], "implicit_euler");
  EXPECT_TRUE(row["growth"].is_null());
  EXPECT_EQ(row["status"], "");
  ASSERT_EQ(row["modes"].size(), 3U);
  for (const nlohmann::json& mode : row["modes"]) {
    // Of y' = i omega y a step makes 1 / (1 - i omega h).
    const std::complex<double> rate =
        -std::log(1.0 - std::complex<double>(0, mode["omega"].get<double>() * 0.01)) / 0.01;
    EXPECT_NEAR(mode["zeta_shown"].get<double>(), -rate.real() / std::abs(rate), 1e-4);
  }
}

TEST(NumericalDampingOfABody, SaysWhatIsWrong) {
  const std::string body = numerical_damping + "--mesh cube:n=2 ";
  expect_refusal(body + "--method rk4 --frequency 8", "remove --frequency");
  expect_refusal(body + "--method cvode_bdf", "chooses its steps itself");
  expect_refusal(body + "--method xpbd", "take one of the two");
  expect_refusal(body + "--method rk4 --load breathing", "never settles");
  expect_refusal(body, "no method is given");
  for (const char* frequency : {"", " --frequency 8"})
    expect_refusal(numerical_damping + "--problem liver_linear --method rk4" + frequency,
                   "is no body on a mesh");
  expect_refusal("stability numerical-damping --mesh cube:n=2 --method rk4", "the step --h [s] is missing");
}

}  // namespace
}  // namespace hmax
