#include <cstdlib>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "results/store.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

constexpr const char* quick = "sweep --methods rk4,ode45 --h 0.2,0.1 --t-end 10 --out quick";

TEST(SweepCommand, MeasuresIntoAStoreAndSaysWhatItDid) {
  const Shell shell;
  const Told told = shell.hmax(std::string(quick) + " --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const auto document = told.json();
  EXPECT_EQ(document["store"], "results/runs/quick.sqlite");
  EXPECT_EQ(document["rows"], 6);
  EXPECT_EQ(document["measured"], 6);
  EXPECT_EQ(document["skipped"], 0);
  EXPECT_GT(document["seconds"], 0);
  const Store store = Store::open_existing(shell / "results/runs/quick.sqlite");
  ASSERT_EQ(store.size(), 6);
  std::multiset<std::string> modes;
  for (const Row& row : store.rows()) modes.insert(row.key.mode);
  EXPECT_EQ(modes.count("fixed"), 4u);
  EXPECT_EQ(modes.count("sampled"), 2u);
}

TEST(SweepCommand, ResumesTheSameSweepOnly) {
  const Shell shell;
  ASSERT_EQ(shell.hmax(quick).exit_code, 0);
  expect_refused(shell.hmax(quick), "--resume");
  const Told again = shell.hmax(std::string(quick) + " --resume --json");
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.json()["skipped"], 6);
  EXPECT_EQ(again.json()["measured"], 0);
  expect_refused(shell.hmax("sweep --methods rk4 --h 0.2,0.1 --t-end 10 --out quick --resume"),
                 "methods was");
}

TEST(SweepCommand, ShowsTheFastestMethodForEachErrorAndWhatToDoNext) {
  const Shell shell;
  const Told told = shell.hmax(quick);
  EXPECT_NE(told.out.find("fastest method"), std::string::npos);
  EXPECT_NE(told.out.find("hmax export results/runs/quick.sqlite"), std::string::npos);
}

TEST(SweepCommand, ReadsAFileAndLetsFlagsGoBeforeIt) {
  const Shell shell;
  write_text(shell / "mine.toml",
             "[sweep]\nmethods = ['rk4']\nh = [0.2, 0.1]\nt_end = 5\nreadings = ['fixed']\n");
  const Told told = shell.hmax("sweep mine.toml --h 0.1 --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.json()["store"], "results/runs/mine.sqlite");
  EXPECT_EQ(told.json()["rows"], 1);
}

TEST(SweepCommand, ADivergedRunIsARowAndNoFailure) {
  const Shell shell;
  const Told told = shell.hmax("sweep --methods explicit_euler --h 2 --out own.sqlite");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NE(told.out.find("1 of them did not reach the end"), std::string::npos) << told.out;
  EXPECT_EQ(Store::open_existing(shell / "own.sqlite").rows().at(0).outcome, "diverged");
}

TEST(SweepCommand, KeepsWhatIsFinishedWhenItIsInterrupted) {
  const Scratch scratch;
  // The study's smallest step alone takes longer than the second after which Ctrl-C is sent.
  const std::string line = "cd '" + scratch.folder().string() +
                           "' && timeout -s INT 1 '" HMAX_PROGRAM
                           "' sweep --methods rk4,ode45,dop_853,fehlberg_78 --out s --json >out 2>err";
  const int status = std::system(line.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 124) << "`timeout` had to interrupt";
  const std::string err = read_text(scratch / "err");
  EXPECT_NE(err.find("--resume measures the rest"), std::string::npos) << err;
  const auto document = nlohmann::json::parse(read_text(scratch / "out"));
  EXPECT_EQ(document["interrupted"], true);
  EXPECT_EQ(document["rows"], document["measured"]);
  EXPECT_EQ(Store::open_existing(scratch / "results/runs/s.sqlite").size(), document["rows"]);
}

TEST(SweepCommand, RefusesBadInputBeforeItMakesAnything) {
  const Shell shell;
  for (const auto& [arguments, named] : std::vector<std::pair<std::string, std::string>>{
           {"--h 0", "--h"},
           {"--h -1", "--h"},
           {"--h nan", "--h"},
           {"--h inf", "--h"},
           {"--h 1e-12", "more than the limit"},
           {"--h 0,1 --sampled", "--h"},
           {"--t-end -5", "before the start"},
           {"--repeats 3", "at least 9"},
           {"--methods rk5", "rk5"},
           {"--problem liver_force", "liver_forced"},
           {"--set q=1", "'q'"},
           {"--materials fat", "fat"},
           {"--out a/b", "--out"},
           {"--readings both", "both"},
           {"--fixed --readings fixed", "one of them"},
           {"--resum", "--resume"},
           {"nowhere.toml", "nowhere.toml"},
       }) {
    SCOPED_TRACE(arguments);
    expect_refused(shell.hmax("sweep " + arguments), named);
    EXPECT_FALSE(std::filesystem::exists(shell / "results"));
  }
}

TEST(SweepCommand, RefusesAFolderThatCannotBeWrittenAndAFileThatIsNoStore) {
  const Shell shell;
  write_text(shell / "results", "a file where a folder should be");
  expect_refused(shell.hmax(quick), "results");
  write_text(shell / "text.sqlite",
             "no store at all, but long enough to be looked at by every reader of stores");
  expect_refused(shell.hmax("sweep --methods rk4 --h 1 --out text.sqlite --resume"), "text.sqlite");
}

}  // namespace
}  // namespace hmax
