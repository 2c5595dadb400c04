/// Where free functions are declared and where they are defined, as the layout of the sources shows it.
#pragma once

#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace hmax::architecture {

/// Names of functions in the first column of a text, with that of the last namespace that began before them;
/// outside of anonymous namespaces and classes.
/// @param defined  those with a body, else those without
inline std::set<std::string> free_functions(const std::string& text, bool defined) {
  static const std::regex name(R"(^[A-Za-z][\w:<>,&* ]*[ &*]([a-z]\w*)\()");
  std::set<std::string> names;
  std::istringstream in(text);
  bool hidden = false;
  std::string space;
  std::string head;  // of a function whose parameters go on in the next lines
  for (std::string line; std::getline(in, line);) {
    if (line == "namespace {") hidden = true;
    if (line == "}  // namespace") hidden = false;
    if (line.starts_with("namespace ") && line.ends_with(" {") && line != "namespace {")
      space = line.substr(10, line.size() - 12) + "::";
    std::smatch found;
    if (std::regex_search(line, found, name) && !line.starts_with("return ") &&
        !line.starts_with("namespace "))
      head = found[1];
    if (head.empty()) continue;
    const bool ends = line.ends_with(';'), begins = line.ends_with('{') || line.ends_with('}');
    if (!ends && !begins) continue;
    if (begins == defined && !hidden) names.insert(space + head);
    head.clear();
  }
  return names;
}

}  // namespace hmax::architecture
