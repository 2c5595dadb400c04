#include <algorithm>

#include "results/store.hpp"
#include "tests/cli/program.hpp"
#include "tests/results/made_rows.hpp"

namespace hmax {
namespace {

/// A store of ten rows whose times are `slowdown` times those of another one; `slow_row` three times that.
void make_store(const std::filesystem::path& file, double slowdown, int slow_row = -1) {
  Store store = Store::open_or_create(file);
  Fingerprint machine;
  machine.cpu = "a test";
  store.begin_session(machine);
  for (int i = 0; i < 10; ++i) {
    Row row = made_row("rk4", 0.01 * (i + 1));
    row.reference = "a test";
    for (int sample = 0; sample < 11; ++sample)
      row.cpu_s.push_back(1e-3 * slowdown * (i == slow_row ? 3 : 1) * (1 + 0.001 * sample));
    store.insert(row);
  }
}

TEST(Export, WritesTheColumnsOfTheContract) {
  const Shell shell;
  make_store(shell / "results/runs/study.sqlite", 1);
  const std::string told = shell.text("export study --format csv");
  EXPECT_EQ(told.rfind("problem,material,method,mode,h,rtol,t_end,outcome,t_reached,steps,rhs,cpu_median_s,"
                       "cpu_q1_s,cpu_q3_s,cpu_p99_s,error_end,error_global,realtime_factor",
                       0),
            0U)
      << told;
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 11);
  EXPECT_EQ(shell.json("export study --format jsonl").size(), 10U);
  EXPECT_TRUE(shell.hmax("export results/runs/study.sqlite --format gbench").json().contains("benchmarks"));
  EXPECT_EQ(shell.hmax("export study --output study.csv").exit_code, 0);
  EXPECT_EQ(read_text(shell / "study.csv"), told);
}

TEST(Export, RefusesADamagedRowAndNamesIt) {
  const Shell shell;
  make_store(shell / "study.sqlite", 1);
  std::string bytes = read_text(shell / "study.sqlite");
  bytes[bytes.find("reached_end") + 3] ^= 1;
  write_text(shell / "study.sqlite", bytes);
  for (const char* command : {"export study.sqlite", "compare study.sqlite study.sqlite",
                              "merge all.sqlite study.sqlite", "report study.sqlite --output page.html"}) {
    const Told told = shell.hmax(command);
    EXPECT_EQ(told.exit_code, 2) << command;
    EXPECT_EQ(told.out, "") << command;
    EXPECT_TRUE(says(told.err, "study.sqlite' is damaged (row "));
    EXPECT_TRUE(says(told.err, "of its table rows: rk4, differs from its digest)"));
  }
}

TEST(Export, RefusesWhatIsNoStore) {
  const Shell shell;
  make_store(shell / "results/runs/study.sqlite", 1);
  write_text(shell / "text.sqlite", "not a store");
  write_text(shell / "byte.sqlite", "x");
  write_text(shell / "nothing.sqlite", "");
  expect_refused(shell.hmax("export studi"), "did you mean 'study'?");
  expect_refused(shell.hmax("export absent/other.sqlite"), "other.sqlite");
  expect_refused(shell.hmax("export text.sqlite"), "text.sqlite");
  expect_refused(shell.hmax("export byte.sqlite"),
                 "'byte.sqlite' is not a store of hmax but some other file");
  expect_refused(shell.hmax("export nothing.sqlite"), "'nothing.sqlite' is empty, not a store");
  expect_refused(shell.hmax("sweep --problem liver_forced --methods rk4 --h 1 --out byte.sqlite"),
                 "left untouched");
  EXPECT_EQ(read_text(shell / "byte.sqlite"), "x");
  expect_refused(shell.hmax("export study --format xml"), "known are csv, jsonl, gbench");
  expect_refused(shell.hmax("export study --output ."), "it is a folder");
  expect_refused(shell.hmax("export"), "hmax export --help");
}

TEST(Compare, ExitsWithOneOnlyForADifferenceOutsideTheNoise) {
  const Shell shell;
  make_store(shell / "a.sqlite", 1);
  make_store(shell / "a_again.sqlite", 1.001);
  make_store(shell / "b.sqlite", 1, 4);
  shell.text("compare a.sqlite a_again.sqlite");
  const Told differs = shell.hmax("compare a.sqlite b.sqlite --json");
  EXPECT_EQ(differs.exit_code, 1);
  EXPECT_EQ(differs.json().at("slower"), 1);
  EXPECT_EQ(differs.json().at("compared"), 10);
  EXPECT_EQ(differs.json().at("rows").size(), 10U);
  EXPECT_TRUE(says(shell.hmax("compare a.sqlite b.sqlite").out, "slower"));
  expect_refused(shell.hmax("compare a.sqlite"), "hmax compare --help");
  expect_refused(shell.hmax("compare a.sqlite none.sqlite"), "none.sqlite");
}

TEST(Compare, ExitsWithOneWhereTheStoresShareNothing) {
  const Shell shell;
  make_store(shell / "a.sqlite", 1);
  Store::open_or_create(shell / "none.sqlite");
  {
    Store other = Store::open_or_create(shell / "other.sqlite");
    other.begin_session({});
    other.insert(made_row("newmark", 0.01));
  }
  for (const char* b : {"none.sqlite", "other.sqlite"}) {
    const Told told = shell.hmax(std::string("compare a.sqlite ") + b);
    EXPECT_EQ(told.exit_code, 1) << b;
    EXPECT_TRUE(says(told.out, "0 rows in both"));
    const bool knows_both = told.out.find("different conditions") != std::string::npos;
    EXPECT_EQ(knows_both, b == std::string("other.sqlite")) << told.out;
  }
}

TEST(Compare, GivesNoNumberWhereThereIsNone) {
  const Shell shell;
  Row fixed = made_row("rk4", 0.01), adaptive = made_row("ode45", 0.01);
  adaptive.key.mode = "adaptive";
  adaptive.key.h = 0;
  adaptive.key.rtol = adaptive.key.atol = 1e-6;
  {
    Store store = Store::open_or_create(shell / "a.sqlite");
    store.begin_session({});
    store.insert(fixed);
    store.insert(adaptive);
  }
  const auto compared = shell.json("compare a.sqlite a.sqlite");
  ASSERT_EQ(compared.at("rows").size(), 2U);
  for (const auto& row : compared.at("rows")) {
    const bool is_fixed = row.at("mode") == "fixed";
    EXPECT_EQ(row.at("h"), is_fixed ? nlohmann::json(0.01) : nlohmann::json()) << row;
    EXPECT_EQ(row.at("rtol"), is_fixed ? nlohmann::json() : nlohmann::json(1e-6)) << row;
  }
}

}  // namespace
}  // namespace hmax
