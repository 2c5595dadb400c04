#include "results/store.hpp"
#include "tests/cli/program.hpp"
#include "tests/plots/pages/reported_stores.hpp"

namespace hmax {
namespace {

namespace fs = std::filesystem;

/// A store file with the rows of `made_store`.
void write_store(const fs::path& file, bool with_rows = true) {
  Store store = Store::open_or_create(file);
  if (!with_rows) return;
  const ReportedStore content = made_store("");
  store.begin_session(content.sessions.front().fingerprint);
  store.insert(content.runs);
  OperatingPointRow point;
  point.key = content.limits.front().point;
  store.insert_limits(point, content.limits);
  store.insert_advice(content.advice.front().key, content.advice);
}

TEST(Report, WritesEveryStoreOfTheFolderAsOnePage) {
  const Shell shell;
  write_store(shell / "results/runs/study.sqlite");
  write_store(shell / "results/runs/deeper/limits.sqlite");
  write_store(shell / "results/runs/deeper/too/deep.sqlite");
  const std::string told = shell.text("report --output page.html");
  EXPECT_EQ(told, "26 rows of 2 stores in page.html\n");
  const std::string page = read_text(shell / "page.html");
  EXPECT_TRUE(says(page, "Take symplectic_euler"));
  EXPECT_TRUE(says(page, "results/runs/deeper/limits.sqlite"));
  EXPECT_FALSE(says(page, "deep.sqlite"));
  EXPECT_EQ(shell.hmax("report --output page.html").exit_code, 0) << "its own page may be replaced";
}

TEST(Report, TakesStoresByPathAndByNameEachOnce) {
  const Shell shell;
  write_store(shell / "results/runs/study.sqlite");
  write_store(shell / "other.sqlite");
  const nlohmann::json told = shell.json("report study other.sqlite study --output folder/page.html");
  EXPECT_EQ(told.at("report"), "folder/page.html");
  EXPECT_EQ(told.at("rows"), 26);
  ASSERT_EQ(told.at("stores").size(), 2U);
  EXPECT_EQ(
      told.at("stores")[0],
      nlohmann::json({{"store", "results/runs/study.sqlite"}, {"runs", 8}, {"limits", 2}, {"advice", 3}}));
  EXPECT_TRUE(fs::exists(shell / "folder/page.html"));
}

TEST(Report, RefusesWhatIsNoStore) {
  const Shell shell;
  expect_refused(shell.hmax("report --output page.html"),
                 "there is no store in results/runs nor in its folders; name the file of a store");
  write_store(shell / "results/runs/study.sqlite");
  write_text(shell / "text.sqlite", std::string(200, 'x'));
  expect_refused(shell.hmax("report text.sqlite --output page.html"), "text.sqlite");
  expect_refused(shell.hmax("report studi --output page.html"), "did you mean 'study'?");
  expect_refused(shell.hmax("report study none.sqlite --output page.html"), "none.sqlite");
  EXPECT_FALSE(fs::exists(shell / "page.html"));
}

TEST(Report, LeavesOutFilesOfTheFolderThatAreNoStores) {
  const Shell shell;
  write_store(shell / "results/runs/study.sqlite");
  write_store(shell / "results/runs/empty.sqlite", false);
  write_text(shell / "results/runs/text.sqlite", std::string(200, 'x'));
  const Told told = shell.hmax("report --output page.html");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.out, "13 rows of 1 store in page.html\n");
  EXPECT_TRUE(says(told.err, "hmax: warning: left out: 'results/runs/text.sqlite'"));
  EXPECT_TRUE(says(told.err, "left out, without rows: 'results/runs/empty.sqlite'"));
}

TEST(Report, RefusesStoresWithoutRows) {
  const Shell shell;
  write_store(shell / "empty.sqlite", false);
  expect_refused(shell.hmax("report empty.sqlite --output page.html"),
                 "no rows to report in 'empty.sqlite'; `hmax sweep --out NAME`");
}

TEST(Report, RefusesPagesThatCannotHaveTheirName) {
  const Shell shell;
  write_store(shell / "study.sqlite");
  expect_refused(shell.hmax("report study.sqlite"), "--output");
  for (const char* name : {"page.md", "page", "study.sqlite"})
    expect_refused(shell.hmax(std::string("report study.sqlite --output ") + name),
                   "let its name end in .html, such as report.html");
  expect_refused(shell.hmax("report study.sqlite --output /dev/null/folder/page.html"),
                 "Cannot write '/dev/null/folder/page.html'");
  write_text(shell / "mine.html", "<p>mine</p>");
  expect_refused(shell.hmax("report study.sqlite --output mine.html"), "--force");
  EXPECT_EQ(read_text(shell / "mine.html"), "<p>mine</p>");
  EXPECT_EQ(shell.hmax("report study.sqlite --output mine.html --force").exit_code, 0);
  EXPECT_EQ(shell.line("mv study.sqlite store.html && hmax report ./store.html --output store.html --force")
                .exit_code,
            2);
}

}  // namespace
}  // namespace hmax
