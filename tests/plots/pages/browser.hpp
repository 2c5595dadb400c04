/// Pages driven in a browser, where there is one.
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

/// What a script of tests/plots/pages finds on a page, by name. It writes lines "name: value" into an element
/// `<pre id="findings">`. `window.page_errors` has the errors of the page.
/// @param options  of `program` besides those for a page without a window
inline std::map<std::string, std::string> findings_on(std::string page, const std::string& script,
                                                      const std::string& program,
                                                      const std::string& options = "--disable-gpu") {
  const auto insert_before = [&](const std::string& place, const std::string& text) {
    page.insert(page.rfind(place), text);
  };
  insert_before("</body>",
                "<script>\n" + read_text(HMAX_SOURCE_DIR "/tests/plots/pages/" + script) + "</script>\n");
  page.insert(page.find("<style>"),
              "<script>window.page_errors = [];\n"
              "addEventListener('error', event => page_errors.push(event.message));\n"
              "addEventListener('unhandledrejection', event => page_errors.push(String(event.reason)));\n"
              "console.error = (...words) => page_errors.push(words.join(' '));</script>\n");
  const Scratch folder;
  write_text(folder / "page.html", page);
  const std::string command =
      "timeout 120 " + program +
      " --headless --no-sandbox --disable-dev-shm-usage --virtual-time-budget=5000 --window-size=1280,900 " +
      options + " --user-data-dir='" + (folder / "profile").string() + "' --dump-dom 'file://" +
      (folder / "page.html").string() + "' >'" + (folder / "dom").string() + "' 2>/dev/null </dev/null";
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
