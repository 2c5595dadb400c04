#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using Json = nlohmann::json;

constexpr const char* small_question =
    "advise --mesh cube:n=2 --model fem_green --load press --rate 100 --frames 50 --methods rk4,newmark";

TEST(AdviseCommand, AnswersInTheKeysOfTheContract) {
  const Shell shell;
  const Told told = shell.hmax(std::string(small_question) + " --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.err, "");
  const Json document = told.json();
  for (const char* key : {"model", "rate", "tolerance", "budget_ms", "machine", "rows", "recommended", "ties", "remedies",
                          "proof", "uncertainty"})
    EXPECT_TRUE(document.contains(key)) << key;
  ASSERT_EQ(document.at("rows").size(), 2U);
  for (const char* key :
       {"method", "options", "h", "steps_per_frame", "h_max", "h_max_observed", "h_accurate", "bound", "error",
        "error_of", "frame_ms", "missed", "frames", "realtime_factor", "memory_bytes", "damping_added", "margin",
        "verdict", "status"})
    EXPECT_TRUE(document.at("rows")[0].contains(key)) << key;
  EXPECT_EQ(document.at("recommended"), document.at("rows")[0]);
  EXPECT_EQ(document.at("recommended").at("verdict"), "recommended");
  EXPECT_EQ(document.at("budget_ms"), 10.0);
}

TEST(AdviseCommand, SaysWhatToTakeAndWhy) {
  const Told told = Shell().hmax(small_question);
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NE(told.out.find("take "), std::string::npos) << told.out;
  EXPECT_NE(told.out.find("limited by "), std::string::npos) << told.out;
  EXPECT_NE(told.out.find(" frames took more than 10 ms"), std::string::npos) << told.out;
}

TEST(AdviseCommand, FailsWhereNothingSuits) {
  const Told told = Shell().hmax(std::string(small_question) + " --budget 1e-6");
  EXPECT_EQ(told.exit_code, 1) << told.err;
  EXPECT_NE(told.out.find("no method that was tried meets this"), std::string::npos) << told.out;
}

TEST(AdviseCommand, KeepsTheAdviceInAStore) {
  const Shell shell;
  const Told told = shell.hmax(std::string(small_question) + " --out kept.sqlite --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const Told rows = shell.hmax("export kept.sqlite --of advice --json");
  ASSERT_EQ(rows.exit_code, 0) << rows.err;
  const Json kept = rows.json(), told_rows = told.json().at("rows");
  ASSERT_EQ(kept.size(), told_rows.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(kept[i].at("method"), told_rows[i].at("method"));
    EXPECT_EQ(kept[i].at("h"), told_rows[i].at("h"));
    EXPECT_EQ(kept[i].at("verdict"), told_rows[i].at("verdict"));
  }
  const Told none = shell.hmax("export kept.sqlite --of limits");
  EXPECT_NE(none.err.find("holds no limits; --of advice writes what it has"), std::string::npos) << none.err;
}

TEST(AdviseCommand, RefusesWrongInput) {
  const Shell shell;
  expect_refused(shell.hmax("advise --problem liver_forced"), "add --rate");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 0"), "--rate is 0");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 1e9"), "between 1 and 100000");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 100 --tolerance 2"), "below 1");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 100 --budget -1"), "--budget is -1");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 100 --methods adams_pece"), "--methods");
  expect_refused(shell.hmax("advise --mesh cube:n=2 --rate 100 --motion-at surface:1"), "--motion");
  expect_refused(shell.hmax("advise --mesh cube:n=2 --rate 100 --motion none.csv"), "none.csv");
}

}  // namespace
}  // namespace hmax
