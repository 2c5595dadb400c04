/// A page over stores in a browser: what its script does when a user sorts, filters, hovers, clicks. Skipped
/// without chromium.
#include <array>
#include <cstdlib>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "plots/pages/store_report.hpp"
#include "tests/plots/pages/reported_stores.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

/// The command that starts the browser; empty where there is none.
std::string browser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    if (std::system((std::string("command -v ") + name + " >/dev/null 2>&1").c_str()) == 0) return name;
  return {};
}

void insert_before(std::string& page, const std::string& place, const std::string& text) {
  page.insert(page.rfind(place), text);
}

/// What tests/plots/pages/store_report_actions.js finds on a page, by name.
std::map<std::string, std::string> findings_on(std::string page, const std::string& program) {
  insert_before(page, "<style>",
                "<script>window.page_errors = [];\n"
                "addEventListener('error', event => page_errors.push(event.message));\n"
                "console.error = (...words) => page_errors.push(words.join(' '));</script>\n");
  insert_before(
      page, "</body>",
      "<script>\n" + read_text(HMAX_SOURCE_DIR "/tests/plots/pages/store_report_actions.js") + "</script>\n");
  const Scratch folder;
  write_text(folder / "page.html", page);
  const std::string command =
      "timeout 120 " + program +
      " --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --virtual-time-budget=5000 "
      "--window-size=1280,900 --user-data-dir='" +
      (folder / "profile").string() + "' --dump-dom 'file://" + (folder / "page.html").string() + "' >'" +
      (folder / "dom").string() + "' 2>/dev/null </dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  const std::string dom = read_text(folder / "dom"), opening = "<pre id=\"findings\">";
  const std::size_t begin = dom.rfind(opening);
  if (begin == std::string::npos) return {};
  std::istringstream text(
      dom.substr(begin + opening.size(), dom.find("</pre>", begin) - begin - opening.size()));
  std::map<std::string, std::string> findings;
  for (std::string line; std::getline(text, line);)
    if (const std::size_t colon = line.find(": "); colon != std::string::npos)
      findings[line.substr(0, colon)] = line.substr(colon + 2);
  return findings;
}

TEST(StoreReportInABrowser, SortsFiltersAndShowsValues) {
  const std::string program = browser();
  if (program.empty())
    GTEST_SKIP() << "chromium is not installed, so the page is not driven; apt-get install chromium";
  ReportedStore store = made_store("a.sqlite", 250);
  store.runs.front().status = "<i class=\"evil\">x</i>";
  store.advice.front().key.motion = "<i class=\"evil\">x</i>";
  const auto findings = findings_on(store_report({&store, 1}, "1.2.3").html, program);
  const std::map<std::string, std::string> expected{{"rows at first", "200"},
                                                    {"count at first", "first 200 of 250 rows"},
                                                    {"sorted up", "true ascending"},
                                                    {"sorted down", "true descending"},
                                                    {"rows printed", "250, drawings 1"},
                                                    {"rows after printing", "200"},
                                                    {"all rows", "250"},
                                                    {"filtered", "63 true"},
                                                    {"theme changes", "true"},
                                                    {"theme returns", "true"},
                                                    {"tip at first", "hidden"},
                                                    {"tip on hover", "true"},
                                                    {"tip after hover", "hidden"},
                                                    {"tip on focus", "true"},
                                                    {"arrow moves", "true"},
                                                    {"mark leads to its row", "true"},
                                                    {"hidden by the legend", "true false"},
                                                    {"shown by the legend", "true true"},
                                                    {"unbounded", "true"},
                                                    {"markup", "0"},
                                                    {"without names", "0"},
                                                    {"wider than a phone", "nothing"},
                                                    {"errors", "none"}};
  EXPECT_EQ(findings, expected);
}

}  // namespace
}  // namespace hmax
