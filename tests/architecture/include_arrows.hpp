/// Which file may include what: the arrows between the folders, and the places where foreign headers may
/// appear.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace hmax::architecture {

/// One #include line. `file` is relative to the project with forward slashes, `header` is what stands between
/// the quotes or angle brackets.
struct Include {
  std::string file, header;
  bool quoted;
};

/// The folders each folder may include; arrows point down only.
inline const std::map<std::string, std::set<std::string>> allowed_arrows{
    {"core", {"core"}},
    {"integrators", {"integrators", "core"}},
    {"problems", {"problems", "core"}},
    {"results", {"results", "core"}},
    {"analysis", {"analysis", "integrators", "problems", "results", "core"}},
    {"catalogue", {"catalogue", "analysis", "integrators", "problems", "results", "core"}},
    {"limits", {"limits", "catalogue", "analysis", "integrators", "problems", "results", "core"}},
    {"bench", {"bench", "catalogue", "analysis", "integrators", "problems", "results", "core"}},
    {"advice",
     {"advice", "limits", "bench", "catalogue", "analysis", "integrators", "problems", "results", "core"}},
    {"studies",
     {"studies", "advice", "limits", "bench", "catalogue", "analysis", "integrators", "problems", "results",
      "core"}},
    {"addons", {"addons", "limits", "catalogue", "analysis", "integrators", "problems", "results", "core"}},
    {"plots", {"plots", "results", "core"}},
    {"cli",
     {"cli", "plots", "studies", "advice", "limits", "bench", "catalogue", "analysis", "integrators",
      "problems", "results", "core"}},
    {"python",
     {"python", "studies", "advice", "limits", "bench", "catalogue", "analysis", "integrators", "problems",
      "results", "core"}},
    {"examples", {"integrators", "problems"}},
    {"tests",
     {"tests", "cli", "plots", "studies", "advice", "limits", "bench", "catalogue", "analysis", "integrators",
      "problems", "results", "core"}},
};

/// A foreign header and the files that may include it, both as regular expressions.
struct ForeignRule {
  std::string header, files;
  std::regex of_header{header}, of_files{files};
};

inline const std::vector<ForeignRule> foreign_rules{
    {"^(sundials|cvodes?|arkode|idas?|kinsol|nvector|sunmatrix|sunlinsol|sunnonlinsol)/",
     "^(integrators/sundials|tests)/"},
    {"^(petsc|slepc)", "^addons/petsc/"},
    {"^mpi", "^addons/"},
    {"^mujoco/", "^(addons/mujoco/|scripts/engines/|tests/python/mujoco_package)"},
    {"^minizip/", "^addons/fmi/"},
    {"^(Bullet|LinearMath/|btBullet)", "^(addons/bullet/|scripts/engines/)"},
    {"^boost/numeric/odeint", "^(integrators/odeint/|bench/micro/|bench/timing/formula_reference|tests/)"},
    {"^benchmark/", "^(bench|limits)/micro/"},
    {"^toml", "\\.cpp$"},
    {"^sqlite3", "^(results/sqlite/.*\\.hpp|(results|tests)/.*\\.cpp)$"},
    {"^results/sqlite/",
     "^(results/sqlite/.*\\.hpp|(results|tests)/.*\\.cpp)$"},  // the wrapper: SQLite stays behind the store
    {"^CLI/", "^cli/"},
    {"^pybind11/", "^(python/bindings/|tests/python/mujoco_package)"},
    {"^cmark", "^plots/pages/markdown_page\\.cpp$"},
    {"^Spectra/", "^limits/micro/references\\.cpp$"},
    {"^metis", "^integrators/linear/elimination_order\\.cpp$"},
    {"^(gtest|gmock)/", "^tests/"},
};

/// The first part of a path: "integrators" of "integrators/system.hpp", empty when there is no slash.
inline std::string folder_of(const std::string& path) {
  return path.substr(0, path.find('/') + 1 ? path.find('/') : 0);
}

/// Nothing when the include is allowed, otherwise one sentence that says why not.
inline std::optional<std::string> violation(const Include& include) {
  const std::string arrow = include.file + " includes " + include.header;
  const std::string from = folder_of(include.file), to = folder_of(include.header);
  if (include.quoted && !allowed_arrows.contains(to))
    return arrow + ": includes are written from the root of the project.";
  if (!include.quoted && allowed_arrows.contains(to)) return arrow + ": own headers stand in quotes.";
  if (include.quoted && !allowed_arrows.at(from).contains(to))
    return arrow + ": no arrow leads from " + from + " to " + to + ".";
  for (const ForeignRule& rule : foreign_rules)
    if (std::regex_search(include.header, rule.of_header) && !std::regex_search(include.file, rule.of_files))
      return arrow + ": this header may stand only in files matching " + rule.files + ".";
  return std::nullopt;
}

/// A header and the source of its name are one file here: "analysis/amplification/region" of
/// "analysis/amplification/region.cpp".
inline std::string unit_of(const std::string& file) { return file.substr(0, file.rfind('.')); }

/// A circle of names in a graph of arrows, in the order of its arrows with the first name repeated at the
/// end; empty when there is none.
inline std::vector<std::string> circle_in(const std::map<std::string, std::set<std::string>>& arrows) {
  enum class State { unseen, on_the_way, done };
  std::map<std::string, State> states;
  std::vector<std::string> way, circle;
  const std::function<void(const std::string&)> visit = [&](const std::string& name) {
    states[name] = State::on_the_way;
    way.push_back(name);
    if (const auto found = arrows.find(name); found != arrows.end())
      for (const std::string& next : found->second) {
        if (!circle.empty()) return;
        if (states[next] == State::unseen) visit(next);
        if (states[next] == State::on_the_way && circle.empty()) {
          circle.assign(std::find(way.begin(), way.end(), next), way.end());
          circle.push_back(next);
        }
      }
    way.pop_back();
    states[name] = State::done;
  };
  for (const auto& [name, targets] : arrows)
    if (circle.empty() && states[name] == State::unseen) visit(name);
  return circle;
}

/// The #include lines of a source text; conditional ones count.
inline std::vector<Include> includes_of(const std::string& file, const std::string& text) {
  static const std::regex include(R"([ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"].*)");
  std::vector<Include> found;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line[first] != '#') continue;
    if (std::smatch match; std::regex_match(line, match, include))
      found.push_back({file, match[2], match[1] == "\""});
  }
  return found;
}

}  // namespace hmax::architecture
