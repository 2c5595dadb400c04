#include <cstdlib>
#include <set>
#include <string>
#include <sys/wait.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "results/store.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

constexpr const char* quick = "sweep --methods rk4,ode45 --h 0.2,0.1 --t-end 10 --out quick";

TEST(SweepCommand, MeasuresIntoAStoreAndSaysWhatItDid) {
  const Shell shell;
  const auto document = shell.json(std::string(quick));
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

TEST(SweepCommand, NamesTheReadingThatMethodsOfTheirOwnStepsNeed) {
  // It advised --fixed, which was given.
  const Told told =
      Shell().hmax("sweep --methods adams_pece --problem liver_linear --h 0.1 --fixed --t-end 1");
  expect_refused(told, "choose their steps themselves; give --sampled");
}

TEST(SweepCommand, KeepsCommasOfNamesInItsLists) {
  const Shell shell;
  write_text(shell / "a,b.toml", "[equations]\nx = \"-x\"\n[initial]\nx = 1\n");
  const std::string matrix = "%%MatrixMarket matrix coordinate real symmetric\n1 1 1\n1 1 4\n";
  write_text(shell / "K.mtx", matrix);
  write_text(shell / "M:1.mtx", matrix);
  const std::string options = " --methods rk4 --h 0.1 --fixed --t-end 1 --json --out ";
  const auto files = shell.json("sweep --problems 'a\\,b.toml,liver_forced'" + options + "files");
  EXPECT_EQ(files["rows"], 2);
  EXPECT_EQ(shell.json("export files")[0]["problem"], "a,b");
  const auto matrices = shell.json("sweep --problems 'matrices:stiffness=K.mtx,mass=M:1.mtx,liver_forced'" +
                                   options + "of_two");
  EXPECT_EQ(matrices["rows"], 2);
  expect_refused(shell.hmax("sweep --problems a,b.toml" + options + "none"), "unknown problem 'a'");
  expect_refused(shell.hmax("reproduce docket --files 'a\\,b.toml' --output docket"), "a,b.toml");
}

TEST(SweepCommand, ExploresOnAllCoresAndKeepsItsTimesOutOfWhatComparesTimes) {
  const Shell shell;
  // Several threads evaluate the formulas.
  write_text(
      shell / "mine.toml",
      "[equations]\nx = \"v\"\nv = \"-c*v - k*x - x^3\"\n[parameters]\nc = 0.4\nk = 1\n[initial]\nx = 0.5\nv = 1\n");
  const std::string options =
      "sweep --problems liver_forced,mine.toml --methods rk4,ode45 --h 0.2,0.1,0.05,0.04 --t-end 10 ";
  const Told told = shell.hmax(options + "--explore --jobs 3 --out e");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_TRUE(says(told.err, "approximate"));
  EXPECT_TRUE(says(told.out, "approximate CPU time [s]"));
  ASSERT_EQ(shell.hmax(options + "--out m").exit_code, 0);
  const auto compared = shell.json("compare m e");
  EXPECT_EQ(compared["same"], 24);
  EXPECT_TRUE(compared["rows"][0]["ratio"].is_null());
  const auto exported = shell.json("export e"), measured = shell.json("export m");
  for (const auto& row : exported) EXPECT_EQ(row["explored"], 1);
  for (const auto& row : measured) EXPECT_EQ(row["explored"], 0);
  const auto benchmarks = shell.hmax("export e --format gbench").json()["benchmarks"];
  EXPECT_EQ(benchmarks.size(), 24U);
  for (const auto& each : benchmarks) EXPECT_EQ(each.value("error_occurred", false), true);
  ASSERT_EQ(shell.hmax("report e --output e.html").exit_code, 0);
  EXPECT_TRUE(says(read_text(shell / "e.html"), "explored, not shown"));
  EXPECT_EQ(shell.json("merge both e m")["rows"], 24);
  for (const auto& row : shell.json("export both")) EXPECT_EQ(row["explored"], 0);
  expect_refused(shell.hmax(options + "--explore --out other --output drawn"), "--output");
  expect_refused(shell.hmax(options + "--explore --out other --publish"), "--publish");
  expect_refused(shell.hmax(options + "--out e --resume"), "explored");
  expect_refused(shell.hmax(options + "--out other --jobs 2"), "--explore");
}

TEST(SweepCommand, MeasuresOnAGpuOrSaysWhyNot) {
  const Shell shell;
  const std::string cube = "sweep --mesh cube:n=2 --h 2e-3,1e-3 --t-end 0.02 ",
                    ask = cube + "--methods symplectic_euler,newmark --device gpu ";
  const Told told = shell.hmax(ask + "--out there --json");
  if (told.exit_code == 0) {
    EXPECT_TRUE(says(told.err, "newmark"));
    EXPECT_EQ(told.json()["rows"], 2);
    EXPECT_NE(told.json()["device"], "");
    const auto here = shell.json(cube + "--methods symplectic_euler --fixed --out here");
    EXPECT_EQ(here.count("device"), 0U);
    const auto a = shell.json("export here"), b = shell.json("export there");
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(b[i]["error_global"], a[i]["error_global"]);
  } else {
    expect_refused(told, "leave out --device");
  }
  expect_refused(shell.hmax(cube + "--device tpu"), "--device");
  expect_refused(shell.hmax(cube + "--methods newmark --device gpu"),
                 "runs none of these methods: newmark runs on no GPU; leave --device out");
  expect_refused(shell.hmax(cube + "--methods pbd --device gpu"), "pbd keeps the lengths of springs");
  expect_refused(shell.hmax("sweep --methods rk4 --device gpu"), "bodies on meshes alone");
  for (const std::string option : {"--sampled", "--explore", "--rtol 1e-3", "--jobs 2"})
    expect_refused(shell.hmax(ask + option),
                   "--device gpu does not take " + option.substr(0, option.find(' ')));
  expect_refused(shell.line("OMPI_COMM_WORLD_SIZE=2 '" HMAX_PROGRAM "' " + ask), "start one, without mpirun");
  write_text(shell / "s.toml", "[sweep]\nreadings = [\"fixed\", \"sampled\"]\n");
  expect_refused(shell.hmax(ask + "s.toml"), "--device gpu does not take --sampled");
}

TEST(SweepCommand, DrawsAFigureForEachProblem) {
  const Shell shell;
  const Told told = shell.hmax(
      "sweep --problems liver_forced,liver_linear --methods rk4,ode45 --h 0.2,0.1 --fixed --t-end 10 --output drawn --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const auto figures = told.json()["figures"];
  if (figures.empty()) {
    EXPECT_TRUE(says(told.err, "gnuplot"));
    return;
  }
  ASSERT_EQ(figures.size(), 2U);
  for (const char* words : {"liver_linear", "rk4", "CPU time"})
    EXPECT_TRUE(says(read_text(shell / figures[1].get<std::string>()), words));
  // Tolerances have no steps to draw over.
  const std::string over =
      shell.text("sweep --methods ode45 --rtol 1e-4,1e-6 --t-end 10 --out over --output drawn_over");
  EXPECT_TRUE(says(over, "The figure: drawn_over/sweep.svg"));
  expect_refused(shell.hmax(std::string(quick) + " --style slide"), "--output");
}

TEST(SweepCommand, MeasuresInShardsWhichMergeIntoOneStore) {
  const Shell shell;
  const std::string whole = "sweep --methods rk4,ode45 --h 0.2,0.1,0.05 --t-end 10";
  const Told told = shell.line("for i in 1 2 3; do hmax " + whole +
                               " --shard $i/3 --json || exit 9; done >&2 && hmax merge whole " +
                               "sweep_1_of_3 sweep_2_of_3 results/runs/sweep_3_of_3.sqlite --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.json()["store"], "results/runs/whole.sqlite");
  EXPECT_EQ(told.json()["inputs"], 3);
  EXPECT_EQ(told.json()["rows"], 9);
  EXPECT_EQ(told.json()["added"], 9);
  EXPECT_EQ(told.json()["doubled"], 0);
  EXPECT_TRUE(told.json()["conflicts"].empty());
  EXPECT_EQ(shell.json(whole + " --out whole --resume")["skipped"], 9);
  EXPECT_EQ(shell.hmax("merge whole sweep_1_of_3").exit_code, 0);
  // More shards than blocks: some have nothing to do.
  for (const char* shard : {"1/40", "40/40"}) {
    shell.text(whole + " --out few --resume --shard " + shard);
  }
  expect_refused(shell.hmax(whole + " --shard 0/3"), "--shard");
  expect_refused(shell.hmax(whole + " --shard 4/3"), "count from 1");
  expect_refused(shell.hmax(whole + " --shard 3"), "I/N");
  expect_refused(shell.hmax(whole + " --shard a/b"), "--shard");
  expect_refused(shell.hmax("merge whole absent"), "absent");
  expect_refused(shell.hmax("merge whole whole"), "output of the merge");
  expect_refused(shell.hmax("precision --methods rk4 --h 0.1 --shard 1/2"), "--store");
}

TEST(PrecisionCommand, MeasuresInShardsAndAnswersFromTheMergedStore) {
  const Shell shell;
  const std::string whole =
      "precision --methods rk4,ode45 --h 0.1,0.05 --rtol 1e-4,1e-6 --t-end 5 --json --store ";
  for (int i = 1; i <= 3; ++i) shell.text(fmt::format("{}{}.sqlite --shard {}/3", whole, i, i));
  ASSERT_EQ(shell.hmax("merge all.sqlite 1.sqlite 2.sqlite 3.sqlite").exit_code, 0);
  const Told merged = shell.hmax(whole + "all.sqlite"), serial = shell.hmax(whole + "serial.sqlite");
  ASSERT_EQ(merged.json().size(), 4U);
  ASSERT_EQ(serial.json().size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    for (const char* key : {"method", "rtol", "h", "error_global", "rhs"})
      EXPECT_EQ(merged.json()[i][key], serial.json()[i][key]) << key;
}

TEST(SweepCommand, ResumesTheSameSweepOnly) {
  const Shell shell;
  ASSERT_EQ(shell.hmax(quick).exit_code, 0);
  expect_refused(shell.hmax(quick), "--resume");
  const nlohmann::json again = shell.json(std::string(quick) + " --resume");
  EXPECT_EQ(again.at("skipped"), 6);
  EXPECT_EQ(again.at("measured"), 0);
  expect_refused(shell.hmax("sweep --methods rk4 --h 0.2,0.1 --t-end 10 --out quick --resume"),
                 "methods was");
}

TEST(SweepCommand, ShowsTheFastestMethodForEachErrorAndWhatToDoNext) {
  const Shell shell;
  const Told told = shell.hmax(quick);
  EXPECT_TRUE(says(told.out, "fastest method"));
  EXPECT_TRUE(says(told.out, "hmax export results/runs/quick.sqlite"));
}

TEST(SweepCommand, ShowsErrorsOfEverySize) {
  const Shell shell;
  for (const char* start : {"1e5", "1", "1e-9"}) {
    const std::string name = fmt::format("from_{}", start);
    write_text(shell / (name + ".toml"),
               fmt::format("[equations]\nx = \"-2*x\"\n[initial]\nx = {}\n", start));
    const Told told = shell.hmax(
        fmt::format("sweep --problem {0}.toml --methods rk4 --h 1,0.001 --fixed --t-end 2 --out {0}", name));
    EXPECT_NE(told.out.find("rk4"), told.out.rfind("rk4")) << "a row for each step in\n" << told.out;
  }
}

TEST(SweepCommand, ReadsAFileAndLetsFlagsGoBeforeIt) {
  const Shell shell;
  write_text(shell / "mine.toml",
             "[sweep]\nmethods = ['rk4']\nh = [0.2, 0.1]\nt_end = 5\nreadings = ['fixed']\n");
  const nlohmann::json told = shell.json("sweep mine.toml --h 0.1");
  EXPECT_EQ(told.at("store"), "results/runs/mine.sqlite");
  EXPECT_EQ(told.at("rows"), 1);
}

TEST(SweepCommand, TakesABodyOnAMeshAsRunsDo) {
  const Shell shell;
  const std::string settings = " --methods rk4 --h 1e-3 --fixed --t-end 0.01 --material male_fat ";
  ASSERT_EQ(shell.hmax("mesh make ball:n=2 --output ball.msh").exit_code, 0);
  shell.text("sweep --mesh ball.msh --unit cm --model mass_spring --load press --out own.sqlite" + settings);
  const auto rows = Store::open_existing(shell / "own.sqlite").rows();
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].key.problem, "mass_spring/press@ball.msh");
  EXPECT_EQ(rows[0].key.material, "male_fat");
  EXPECT_EQ(rows[0].key.y0, "rest");
  EXPECT_EQ(rows[0].outcome, "reached_end");
  EXPECT_GT(rows[0].error_global, 0);
  EXPECT_LT(rows[0].error_global, 1e-4);
  // The id says the same, and so does a file of a sweep, which looks for the mesh beside itself.
  const Told by_id = shell.hmax(
      "sweep --problem mass_spring/press@ball.msh --unit cm --resume --json --out own.sqlite" + settings);
  EXPECT_EQ(by_id.json()["skipped"], 1) << by_id.err;
  std::filesystem::create_directory(shell / "folder");
  write_text(shell / "folder/body.toml",
             "[sweep]\nproblems = 'mass_spring/press@ball.msh'\nunit = 'cm'\nmaterials = 'male_fat'\n"
             "methods = 'rk4'\nh = 1e-3\nreadings = 'fixed'\nt_end = 0.01\n");
  std::filesystem::rename(shell / "ball.msh", shell / "folder/ball.msh");
  shell.text("sweep folder/body.toml --out other.sqlite --json");
  EXPECT_EQ(Store::open_existing(shell / "other.sqlite").rows().at(0).error_global, rows[0].error_global);
}

TEST(SweepCommand, SaysWhatIsWrongWithABody) {
  const Shell shell;
  expect_refused(shell.hmax("sweep --mesh phantom --problem liver_linear --methods rk4 --h 0.1"), "--mesh");
  expect_refused(shell.hmax("sweep --model fem_green --methods rk4 --h 0.1"), "--model");
  expect_refused(shell.hmax("sweep --mesh fantom --methods rk4 --h 0.1"), "phantom");
  expect_refused(shell.hmax("sweep --mesh phantom --unit cm --methods rk4 --h 0.1"), "unit");
}

TEST(SweepCommand, TellsMeshesApartByWhatIsInTheirFiles) {
  const Shell shell;
  const std::string sweep =
      "sweep --mesh it.msh --unit m --methods rk4 --h 1e-3 --fixed --t-end 0.002 --out s.sqlite";
  ASSERT_EQ(shell.hmax("mesh make ball:n=2 --output it.msh").exit_code, 0);
  ASSERT_EQ(shell.hmax(sweep).exit_code, 0);
  EXPECT_EQ(shell.json(sweep + " --resume")["skipped"], 1);
  ASSERT_EQ(shell.hmax("mesh make ball:n=2,radius=0.06 --output it.msh").exit_code, 0);
  expect_refused(shell.hmax(sweep + " --resume"), "problems");
}

TEST(SweepCommand, ADivergedRunIsARowAndNoFailure) {
  const Shell shell;
  const std::string told = shell.text("sweep --methods explicit_euler --h 2 --out own.sqlite");
  EXPECT_TRUE(
      says(told, "1 of them did not reach the end:\n  explicit_euler, fixed, h = 2 s: diverged at t = "));
  EXPECT_EQ(Store::open_existing(shell / "own.sqlite").rows().at(0).outcome, "diverged");
}

TEST(SweepCommand, ShowsNoTableWithoutARowAndQuotesTheNameOfItsStore) {
  const Shell shell;
  const std::string told =
      shell.text("sweep --methods explicit_euler --h 2 --fixed --t-end 40 --out 'my own.sqlite'");
  EXPECT_FALSE(says(told, "fastest method"));
  EXPECT_TRUE(says(told, "All of it: hmax export 'my own.sqlite' --format csv\n"));
}

TEST(SweepCommand, RefusesAParameterThatIsGivenTwice) {
  const Shell shell;
  expect_refused(shell.hmax("sweep --methods rk4 --h 1 --set P=1 --set P=2 --out s"),
                 "--set P is given twice; leave one of them out");
  expect_refused(shell.hmax("run --problem liver_forced --method rk4 --h 1 --set P=1 --set w=1 --set P=1"),
                 "--set P is given twice");
}

TEST(SweepCommand, ListsTheRowsThatDidNotReachTheEnd) {
  const Shell shell;
  const auto sweep = shell.json("sweep --methods explicit_euler --h 2,0.1 --fixed --out own.sqlite");
  ASSERT_EQ(sweep["failed"].size(), 1U) << sweep;
  EXPECT_EQ(sweep["failed"][0]["method"], "explicit_euler");
  EXPECT_EQ(sweep["failed"][0]["h"], 2);
  EXPECT_EQ(sweep["failed"][0]["outcome"], "diverged");
}

TEST(SweepCommand, KeepsWhatIsFinishedWhenItIsInterrupted) {
  const Scratch scratch;
  // The study's smallest step alone takes longer than the second after which Ctrl-C is sent.
  const std::string line = "cd '" + scratch.folder().string() +
                           "' && timeout --foreground -s INT 1 '" HMAX_PROGRAM
                           "' sweep --methods rk4,ode45,dop_853,fehlberg_78 --out s --json >out 2>err";
  const int status = std::system(line.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 124) << "`timeout` had to interrupt";
  const std::string err = read_text(scratch / "err");
  EXPECT_TRUE(says(err, "--resume measures the rest"));
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

TEST(SweepCommand, StatesItsTolerances) {
  const Shell shell;
  const auto both = [](double rtol, double atol) {
    return nlohmann::json{{"mode", "sampled"}, {"rtol", rtol}, {"atol", atol}};
  };
  const std::string sampled = "sweep --methods ode45 --h 1,0.5 --sampled --t-end 2 --out ";
  EXPECT_EQ(shell.json(sampled + "a").at("tolerances"), nlohmann::json::array({both(1e-6, 1e-6)}));
  EXPECT_EQ(shell.json(sampled + "b --rtol 1e-5 --atol 1e-7").at("tolerances"),
            nlohmann::json::array({both(1e-5, 1e-7)}));
  EXPECT_EQ(shell.json("sweep --methods rk4 --h 1 --t-end 2 --out c").at("tolerances"),
            nlohmann::json::array());
  const Told words = shell.hmax(sampled + "d");
  EXPECT_TRUE(says(words.out, "sampled at rtol 1e-06, atol 1e-06"));
  const Told adaptive = shell.hmax("sweep --methods ode45 --rtol 1e-4 --atol 1e-5 --t-end 2 --out e");
  EXPECT_TRUE(says(adaptive.out, "rtol 1e-04, atol 1e-05"));
}

TEST(SweepCommand, NamesMethodsThatItDoesNotRunAndRunsNoOthersInTheirPlace) {
  const Shell shell;
  const Told none =
      shell.hmax("sweep --problem hires --methods structural --h 0.1 --fixed --t-end 1 --out none");
  expect_refused(none, "newmark");
  EXPECT_FALSE(std::filesystem::exists(shell / "results/runs/none.sqlite"));
  const Told some = shell.hmax("sweep --methods rk4,ode45 --rtol 1e-4 --t-end 1 --out some");
  EXPECT_EQ(some.exit_code, 0) << some.err;
  EXPECT_TRUE(says(some.err, "hmax: warning: left out: rk4: has no error estimate"));
}

}  // namespace
}  // namespace hmax
