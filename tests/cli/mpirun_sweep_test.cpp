/// mpirun -n 2 hmax sweep, where Open MPI is there.
#include <fstream>
#include <vector>

#include "results/compare.hpp"
#include "results/store.hpp"
#include "tests/cli/mpirun.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using nlohmann::json;

const std::string on_two = mpirun_two + HMAX_PROGRAM " ";

void expect_same_rows(const Shell& shell, const std::string& found, const std::string& expected) {
  const std::vector<Row> rows = Store::open_existing(shell / found).rows(),
                         others = Store::open_existing(shell / expected).rows();
  ASSERT_EQ(rows.size(), others.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].key, others[i].key);
    for (const std::string& change : changes_between(others[i], rows[i]))
      ADD_FAILURE() << rows[i].key.method << " " << change;
    EXPECT_EQ(rows[i].cpu_s.size(), others[i].cpu_s.size());
  }
}

class MpirunSweep : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_built_with("OpenMPI")) GTEST_SKIP() << "this build has no MPI: libopenmpi-dev was missing";
    if (!starts_two_processes()) GTEST_SKIP() << "mpirun starts no two processes here";
  }
  [[nodiscard]] Told line(const std::string& command) const { return shell.line(with_mpi + command); }
  [[nodiscard]] Told two(const std::string& arguments) const {
    return line("timeout 180 " + on_two + arguments);
  }

  /// Starts `sweep` on two ranks, and once more rows are stored than before runs `then`, which knows the
  /// process of mpirun as $job and those of its ranks as $1 and $2.
  [[nodiscard]] Told two_until(const std::string& sweep, const std::string& then) const {
    return line(
        "rows() { hmax export a.sqlite --format csv 2>/dev/null | tail -n +2 | wc -l; }; before=$(rows); " +
        on_two + sweep +
        " & job=$!; for i in $(seq 600); do [ $(rows) -gt $before ] && break; sleep 0.05; done; " +
        "set -- $(cat /proc/$job/task/*/children); " + then +
        "; wait $job; code=$?; sleep 1; grep -s '^State:.[RSDT]' /proc/$1/status /proc/$2/status && exit 99; exit $code");
  }

  Shell shell;
};

constexpr const char* liver_sweep =
    "sweep --problems liver_forced,liver_linear --methods rk4,ode45 --h 0.2,0.1,0.001 --t-end 10 ";
// Sixteen blocks of 13 rows, each of a quarter of a second.
constexpr const char* longer =
    "sweep --methods explicit_runge_kutta --repeats 10 --fixed --t-end 50 "
    "--h 0.2,0.19,0.18,0.17,0.16,0.15,0.14,0.13,0.12,0.11,0.1,0.09,0.08,0.07,0.06,0.05 ";

TEST_F(MpirunSweep, HasTheRowsOfASerialSweep) {
  for (const std::string options : {"", "--explore "}) {
    const std::string sweep = liver_sweep + options;
    const Told told = two(sweep + "--json --out two.sqlite");
    ASSERT_EQ(told.exit_code, 0) << told.err;
    EXPECT_EQ(told.json()["measured"], 18);
    ASSERT_EQ(shell.hmax(sweep + "--out one.sqlite").exit_code, 0);
    expect_same_rows(shell, "two.sqlite", "one.sqlite");
    for (const Row& row : Store::open_existing(shell / "two.sqlite").rows()) EXPECT_TRUE(row.explored);
    EXPECT_TRUE(says(told.json()["warnings"].dump(), "approximate"));
    // Either form goes on where the other one ended; one that measures takes the rows anew whose times are
    // rough.
    const json again = shell.json(sweep + "--out two.sqlite --resume");
    EXPECT_EQ(again["skipped"], options.empty() ? 0 : 18);
    EXPECT_EQ(again["measured"], options.empty() ? 18 : 0);
    for (const Row& row : Store::open_existing(shell / "two.sqlite").rows())
      EXPECT_EQ(row.explored, !options.empty());
    EXPECT_EQ(two(sweep + "--out one.sqlite --resume --json").json()["skipped"], 18);
    for (const char* file : {"one.sqlite", "two.sqlite"}) std::filesystem::remove(shell / file);
  }
}

TEST_F(MpirunSweep, KilledRanksLoseNoStoredRowAndResumeGivesTheRest) {
  const std::string sweep = std::string(longer) + "--out a.sqlite --resume --json";
  std::int64_t before = 0;
  for (const char* rank : {"$1", "$2"}) {
    const Told told = two_until(sweep, std::string("kill -9 ") + rank);
    EXPECT_NE(told.exit_code, 0) << told.out;
    EXPECT_NE(told.exit_code, 99) << "a rank is left behind";
    const std::int64_t rows = Store::open_existing(shell / "a.sqlite").size();
    EXPECT_GT(rows, before);
    before = rows;
  }
  const json rest = two(sweep).json();
  EXPECT_EQ(rest["skipped"], before);
  EXPECT_GT(rest["measured"], 0) << "ranks were killed too late for this test to show anything";
  ASSERT_EQ(shell.hmax(std::string(longer) + "--out serial.sqlite").exit_code, 0);
  expect_same_rows(shell, "a.sqlite", "serial.sqlite");
}

TEST_F(MpirunSweep, AnInterruptEndsAllRanksAndKeepsTheRows) {
  const std::string sweep = std::string(longer) + "--out a.sqlite --resume --json";
  // Ctrl-C reaches mpirun; a rank may be interrupted, too.
  for (const char* process : {"$job", "$1", "$2"}) {
    const Told told = two_until(sweep, std::string("kill -INT ") + process);
    EXPECT_NE(told.exit_code, 0) << process << told.out;
    if (process[1] != 'j') {
      EXPECT_EQ(told.exit_code, 130) << process << told.err;
    }
    EXPECT_NE(told.exit_code, 99) << process << " left a rank behind";
  }
  EXPECT_GE(Store::open_existing(shell / "a.sqlite").size(), 4);
}

TEST_F(MpirunSweep, TellsAnErrorOnce) {
  ASSERT_EQ(two(std::string(liver_sweep) + "--out there.sqlite").exit_code, 0);
  for (const auto& [arguments, named] : std::initializer_list<std::pair<std::string, const char*>>{
           {"sweep --methods none", "unknown method 'none'"},
           {"sweep --no-such-option", "--no-such-option"},
           {"sweep nowhere.toml", "nowhere.toml"},
           {std::string(liver_sweep) + "--out there.sqlite", "--resume"},
           {std::string(liver_sweep) + "--output drawn", "--output"},
           {std::string(liver_sweep) + "--publish", "--publish"},
           {std::string(liver_sweep) + "--explore --jobs 2", "--jobs"},
           {"merge other.sqlite there.sqlite", "2 copies"}}) {
    const Told told = two(arguments);
    EXPECT_EQ(told.exit_code, 2) << arguments;
    EXPECT_EQ(told.out, "") << arguments;
    const std::size_t first = told.err.find("hmax: ");
    ASSERT_NE(first, std::string::npos) << arguments;
    EXPECT_TRUE(says(told.err, named));
    EXPECT_EQ(told.err.find("hmax: ", first + 1), std::string::npos) << told.err;
  }
}

TEST_F(MpirunSweep, RanksWithDifferentOptionsAreRefused) {
  const Told told = line("timeout 180 mpirun --oversubscribe -n 1 " HMAX_PROGRAM
                         " sweep --methods rk4 --h 0.1 : -n 1 " HMAX_PROGRAM " sweep --methods rk4 --h 0.2");
  EXPECT_EQ(told.exit_code, 2) << told.err;
  EXPECT_TRUE(says(told.err, "rank 1 has another sweep"));
}

TEST_F(MpirunSweep, AnotherMpirunIsRefused) {
  expect_refused(line("PMI_SIZE=3 hmax " + std::string(liver_sweep)), "another mpirun");
}

TEST(MpirunSweeps, ABuildWithoutMpiSaysSo) {
  if (is_built_with("OpenMPI")) GTEST_SKIP() << "this build has MPI";
  expect_refused(Shell().line("OMPI_COMM_WORLD_SIZE=2 hmax " + std::string(liver_sweep)),
                 "built without MPI");
}

/// The lines of scripts/scaling-model on a sweep of these tasks, of which rank 0 takes 1 ms for each hand.
Told modelled(const std::vector<double>& seconds, const std::string& options) {
  const Shell shell;
  json tasks = json::array();
  for (const double length : seconds)
    tasks.push_back(
        {{"rank", 0}, {"problem", "p"}, {"rows", 1}, {"expected_seconds", length}, {"seconds", length}});
  std::ofstream(shell / "tasks.json") << json{{"ranks", 2},
                                              {"seconds", 1},
                                              {"measured", seconds.size()},
                                              {"batches", 4},
                                              {"distribution_seconds", 4e-3},
                                              {"tasks", tasks}};
  return shell.line("'" HMAX_SOURCE_DIR "/scripts/scaling-model' tasks.json --latency 0 " + options);
}

TEST(ScalingModel, TimesOfSimpleSweepsAreThoseByHand) {
  if (Shell().line("python3 --version").exit_code != 0) GTEST_SKIP() << "there is no python3";
  // Eight tasks of 2 s on 4 ranks. The last rank gets its hands behind three others, and is back behind none.
  EXPECT_TRUE(says(modelled(std::vector(8, 2.0), "--ranks 4").out, "    4     4.006"));
  // The longest task bounds the time.
  EXPECT_TRUE(says(modelled({9, 1, 1, 1}, "--ranks 1000").out, " 1000     9.002"));
  const Told told = modelled({}, "");
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_TRUE(says(told.err, "not of a sweep under mpirun"));
}

TEST(MpirunSweeps, TheProgramItselfLoadsNoMpi) {
  EXPECT_EQ(Shell().line("ldd '" HMAX_PROGRAM "' | grep -c libmpi").out, "0\n");
}

}  // namespace
}  // namespace hmax
