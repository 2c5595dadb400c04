/// Pages driven in Chromium: a script acts on the page and tells what it finds.
#pragma once

#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/results/scratch.hpp"

namespace hmax {

/// The command that starts the browser; empty where there is none.
inline std::string browser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    if (std::system((std::string("command -v ") + name + " >/dev/null 2>&1").c_str()) == 0) return name;
  return {};
}

/// What a script of tests/plots/pages finds on a page, by name: it appends an element `pre` with the id
/// "findings" and a line "name: value" for each. `window.page_errors` has the errors of the page.
/// @param actions  name of the file of the script
/// @param options  of `program` besides those for a page without a window
inline std::map<std::string, std::string> findings_on(std::string page, const std::string& program,
                                                      const std::string& actions,
                                                      const std::string& options) {
  page.insert(page.rfind("<style>"),
              "<script>window.page_errors = [];\n"
              "addEventListener('error', event => page_errors.push(event.message));\n"
              "addEventListener('unhandledrejection', event => page_errors.push(String(event.reason)));\n"
              "console.error = (...words) => page_errors.push(words.join(' '));</script>\n");
  page.insert(page.rfind("</body>"),
              "<script>\n" + read_text(HMAX_SOURCE_DIR "/tests/plots/pages/" + actions) + "</script>\n");
  const Scratch folder;
  write_text(folder / "page.html", page);
  const std::string command = "timeout 120 " + program +
                              " --headless --no-sandbox --disable-dev-shm-usage --virtual-time-budget=5000 "
                              "--window-size=1280,900 " +
                              options + " --user-data-dir='" + (folder / "profile").string() +
                              "' --dump-dom 'file://" + (folder / "page.html").string() + "' >'" +
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

}  // namespace hmax
