/// Every command that takes models and methods, on models that do and do not suit the families it is asked
/// for.
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <sys/resource.h>
#include <vector>

#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using nlohmann::json;

struct Model {
  std::string options;
  std::string name;  ///< in rows
  bool positions;    ///< has positions and velocities, which structural methods step
  bool stiff_part;   ///< declares one, which implicit-explicit methods take
  bool linear;       ///< has no motion along which limits change
  std::string axes;  ///< two parameters for a map
};

const std::vector<Model>& models() {
  static const std::vector<Model> all{
      {"--problem liver_linear", "liver_linear", true, true, true, "c=0.1:1:2 k1=1:5:2"},
      {"--problem van_der_pol --set mu=2", "van_der_pol", false, false, false, "mu=1:2:2 mu=1:2:2"},
      {"--problem dahlquist", "dahlquist", false, false, true, "lambda=-2:-1:2 lambda=-2:-1:2"},
      {"--problem lorenz", "lorenz", false, false, false, "sigma=5:10:2 rho=0.1:0.5:2"},
      {"--problem strip.toml", "strip", true, false, false, "c=0.1:1:2 k=30:40:2"},
      {"--matrices stiffness=K.mtx,mass=M.mtx", "matrices:stiffness=K.mtx,mass=M.mtx", true, false, true,
       "alpha=0:1:2 beta=0:0.1:2"},
      {"--matrices jacobian=J.mtx", "matrices:jacobian=J.mtx", false, false, true,
       "alpha=0:1:2 beta=0:0.1:2"},
      {std::string("--plugin ") + EXAMPLE_MODEL, "pendulum#", true, false, false, "k=1:2:2 m=1:2:2"},
      {"--mesh cube:n=1 --beta 0.003", "fem_green@cube:n=1", true, true, true,
       "E=5000:6000:2 rho=900:1000:2"}};
  return all;
}

/// The files that they name: the strip of docs/howto/own_model.md, a chain of two masses, and y' = J y.
void write_models(const Shell& shell) {
  write_text(shell / "strip.toml",
             "[problem]\nt_end = 2\n[equations]\nx = \"v\"\nv = \"9.81 - (c*v + k*x*exp(x/l)) / m\"\n"
             "[parameters]\nm = 0.1\nc = 0.4\nk = 40\nl = 0.02\n[initial]\nx = 0\nv = 0\n");
  const std::string symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
  write_text(shell / "K.mtx", symmetric + "2 2 3\n1 1 200\n2 1 -100\n2 2 100\n");
  write_text(shell / "M.mtx", symmetric + "2 2 2\n1 1 1\n2 2 1\n");
  write_text(shell / "J.mtx",
             "%%MatrixMarket matrix coordinate real general\n2 2 3\n1 1 -2\n1 2 1\n2 2 -5\n");
}

struct ListedMethod {
  std::string id;
  bool positions, stiff_part, adaptive;

  [[nodiscard]] bool suits(const Model& model) const {
    return (!positions || model.positions) && (!stiff_part || model.stiff_part);
  }
};

struct ListedFamily {
  std::string name;
  std::vector<ListedMethod> methods{};

  [[nodiscard]] bool any(bool ListedMethod::*fact, bool value) const {
    return std::ranges::any_of(methods, [&](const ListedMethod& m) { return m.*fact == value; });
  }
};

/// All that the program knows.
std::vector<ListedFamily> families(const Shell& shell) {
  std::vector<ListedFamily> all;
  for (const json& each : shell.json("list methods")) {
    if (all.empty() || all.back().name != each["family"].get<std::string>()) all.push_back({each["family"]});
    all.back().methods.push_back(
        {each["id"], each["needs_second_order"], each["needs_split"], each["adaptive"]});
  }
  return all;
}

struct Command {
  std::string name;
  bool one_method;                    ///< takes a method in place of families
  std::vector<std::string> settings;  ///< one of them at a time
  std::string kept{};                 ///< what of a store `hmax export` shows
};

const std::vector<Command>& commands() {
  static const std::vector<Command> all{{"stability predict",
                                         false,
                                         {"", "--out s.sqlite", "--verify", "--along none", "--along motion"},
                                         "limits"},
                                        {"stability map", false, {"", "--output map"}},
                                        {"sweep", false, {"--fixed", "--sampled", ""}, "runs"},
                                        {"precision", false, {"", "--store s.sqlite"}, "runs"},
                                        {"advise", false, {"", "--out s.sqlite"}, "advice"},
                                        {"run", true, {"", "--output motion.csv", "--checkpoint checkpoint"}},
                                        {"phase", true, {"", "--output phase"}},
                                        {"order", true, {""}}};
  return all;
}

/// One value of each factor, by its index.
struct Case {
  std::size_t command, model, family, setting;
  bool as_json;
};

struct CrossedCases {
  std::vector<ListedFamily> families;

  [[nodiscard]] const Command& command(const Case& c) const { return commands()[c.command]; }
  [[nodiscard]] const Model& model(const Case& c) const { return models()[c.model]; }
  [[nodiscard]] const ListedFamily& family(const Case& c) const { return families[c.family]; }

  /// Those that a row may have.
  [[nodiscard]] std::set<std::string> suited(const Case& c) const {
    std::set<std::string> ids;
    for (const ListedMethod& method : family(c).methods)
      if (method.suits(model(c)) && (ids.empty() || !command(c).one_method)) ids.insert(method.id);
    if (command(c).one_method && !family(c).methods.front().suits(model(c))) ids.clear();
    return ids;
  }

  /// Advice about motions of 2000 s, chaotic ones or a plugin takes minutes, and so do the runs of --verify
  /// for a plugin, a chaotic motion or many methods: only their refusal is tried.
  [[nodiscard]] bool affordable(const Case& c) const {
    const std::string& name = model(c).name;
    const bool plugin = name == "pendulum#", slow = plugin || name == "van_der_pol" || name == "lorenz";
    const bool long_runs = plugin || name == "lorenz" || family(c).methods.size() > 10;
    const bool too_slow =
        (slow && command(c).name == "advise") || (long_runs && command(c).settings[c.setting] == "--verify");
    return !too_slow || suited(c).empty();
  }

  /// What one case covers: every pair of values, and command and model with whether a method suits.
  [[nodiscard]] std::set<std::array<std::size_t, 5>> covers(const Case& c) const {
    const std::size_t suits = suited(c).empty() ? 0 : 1;
    const std::array<std::size_t, 6> values{c.command, c.model, c.family,
                                            // A setting belongs to its command.
                                            10 * c.command + c.setting, c.as_json ? 1UL : 0UL, suits};
    std::set<std::array<std::size_t, 5>> pairs{{9, c.command, c.model, suits, 0}};
    for (std::size_t i = 0; i < values.size(); ++i)
      for (std::size_t j = i + 1; j < values.size(); ++j) pairs.insert({i, j, values[i], values[j], 0});
    return pairs;
  }

  /// A covering array: each case is the first one that covers most of what is left.
  [[nodiscard]] std::vector<Case> cases() const {
    std::vector<Case> all;
    for (std::size_t c = 0; c < commands().size(); ++c)
      for (std::size_t m = 0; m < models().size(); ++m)
        for (std::size_t f = 0; f < families.size(); ++f)
          for (std::size_t s = 0; s < commands()[c].settings.size(); ++s)
            for (const bool as_json : {false, true})
              if (const Case one{c, m, f, s, as_json}; affordable(one)) all.push_back(one);
    std::map<std::array<std::size_t, 5>, std::size_t> number;  // of what is to be covered
    std::vector<std::vector<std::size_t>> covered;
    for (const Case& one : all) {
      covered.emplace_back();
      for (const auto& pair : covers(one))
        covered.back().push_back(number.try_emplace(pair, number.size()).first->second);
    }
    std::vector<bool> missing(number.size(), true);
    // What a case covers of what is left, or did at a choice before: it never grows.
    std::vector<std::ptrdiff_t> news;
    for (const std::vector<std::size_t>& pairs : covered) news.push_back(std::ssize(pairs));
    std::vector<Case> chosen;
    for (;;) {
      std::size_t best = 0;
      std::ptrdiff_t most = 0;
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (news[i] <= most) continue;
        news[i] = std::ranges::count_if(covered[i], [&](std::size_t pair) { return missing[pair]; });
        if (news[i] > most) best = i, most = news[i];
      }
      if (most == 0) return chosen;
      chosen.push_back(all[best]);
      for (const std::size_t pair : covered[best]) missing[pair] = false;
    }
  }

  /// As typed after `hmax`.
  [[nodiscard]] std::string line(const Case& c) const {
    const auto& [name, one_method, settings, kept] = command(c);
    std::string line = name + " " + model(c).options + " --methods ";
    if (one_method) line.replace(line.size() - 2, 2, " ");
    line += (one_method ? family(c).methods.front().id : family(c).name) + " " + settings[c.setting];
    if (name == "stability predict") line += " --jobs 1";
    const bool along = settings[c.setting] == "--along motion" ||
                       (!model(c).linear && settings[c.setting] != "--along none");
    if (name == "stability predict" && along) line += " --t-end 0.5";
    if (name == "stability map") {
      const std::string axes = model(c).axes;
      const std::size_t space = axes.find(' ');
      line += " --x " + axes.substr(0, space) + " --y " + axes.substr(space + 1);
    }
    if (name == "sweep") line += " --h 0.001 --t-end 0.01 --explore --jobs 1 --out s.sqlite";
    if (name == "precision") {
      line += " --t-end 0.01 --budget 0.0001";
      if (family(c).any(&ListedMethod::adaptive, true)) line += " --rtol 1e-3";
      if (family(c).any(&ListedMethod::adaptive, false)) line += " --h 0.001";
    }
    if (name == "advise") line += " --rate 100 --frames 3 --tolerance 0.1";
    if (name == "run") line += " --h 0.001 --t-end 0.01";
    if (name == "phase") line += " --h 0.001 --window -1,1,-1,1";
    if (name == "order") line += " --t-end 0.01";
    return line + (c.as_json ? " --json" : "");
  }
};

/// Lines on standard error that are no warnings.
std::vector<std::string> sentences(const std::string& err) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < err.size();) {
    const std::size_t end = std::min(err.find('\n', from), err.size());
    const std::string line = err.substr(from, end - from);
    if (!line.starts_with("hmax: warning: ")) lines.push_back(line);
    from = end + 1;
  }
  return lines;
}

/// The rows of a document, or of the answer to one method.
std::vector<json> rows_of(const json& document) {
  if (document.is_array()) return document;
  const auto rows = document.find("rows");
  if (rows != document.end() && rows->is_array() && !document.contains("method")) return *rows;
  return {document};
}

/// @param err  what was said of methods without a row
void expect_rows(const std::vector<json>& rows, const std::set<std::string>& suited, const Model& model,
                 const std::string& err) {
  EXPECT_FALSE(rows.empty());
  for (const std::string& id : suited) {
    const bool shown = std::ranges::any_of(rows, [&](const json& row) { return row.at("method") == id; });
    EXPECT_TRUE(shown || err.find(id) != std::string::npos) << id << " has no row and no reason";
  }
  for (const json& row : rows) {
    EXPECT_TRUE(suited.contains(row.at("method"))) << row.at("method");
    if (row.contains("problem")) {
      EXPECT_TRUE(row["problem"].get<std::string>().starts_with(model.name)) << row["problem"];
    }
  }
}

/// The methods that begin the lines of a table.
void expect_table(const std::string& text, const std::set<std::string>& suited,
                  const std::vector<ListedFamily>& all) {
  std::set<std::string> known;
  for (const ListedFamily& family : all)
    for (const ListedMethod& method : family.methods) known.insert(method.id);
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::string line = text.substr(from, end - from), word = line.substr(0, line.find(' '));
    if (known.contains(word)) {
      EXPECT_TRUE(suited.contains(word)) << line;
    }
    from = end + 1;
  }
}

void expect_right(const CrossedCases& crossing, const Case& one, const Shell& shell, const Told& told) {
  const std::set<std::string> suited = crossing.suited(one);
  const Command& command = crossing.command(one);
  ASSERT_TRUE(told.exit_code >= 0 && told.exit_code <= 2) << told.exit_code << " " << told.err;
  if (suited.empty()) {
    EXPECT_EQ(told.exit_code, 2) << told.out;
  }
  const std::vector<std::string> said = sentences(told.err);
  if (told.exit_code == 2) {
    ASSERT_EQ(said.size(), 1U) << told.err;
    EXPECT_TRUE(said.front().starts_with("hmax: ")) << told.err;
    EXPECT_EQ(told.out, "");
    return;
  }
  for (const std::string& line : said) EXPECT_TRUE(line.starts_with("hmax: ")) << line;
  if (one.as_json) {
    const json document = told.json();
    // A sweep counts its rows.
    if (command.name != "sweep") expect_rows(rows_of(document), suited, crossing.model(one), told.err);
  } else {
    expect_table(told.out, suited, crossing.families);
  }
  if (std::filesystem::exists(shell / "s.sqlite")) {
    const nlohmann::json kept = shell.json("export s.sqlite --of " + command.kept);
    expect_rows(rows_of(kept), suited, crossing.model(one), told.err);
  }
}

double child_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// The cases take more than a minute: every fourth of them is a test of its own.
constexpr std::size_t parts = 4;
class CrossedCommands : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Part, CrossedCommands, testing::Range(std::size_t{0}, parts));

TEST_P(CrossedCommands, ModelsAndFamiliesAreAnsweredWithRowsOfTheFamilyOrRefusedInOneSentence) {
  const CrossedCases crossing{families(Shell())};
  ASSERT_GE(crossing.families.size(), 8U);
  const std::vector<Case> cases = crossing.cases();
  const double before = child_seconds();
  std::map<int, std::size_t> codes;
  std::map<std::string, double> seconds;
  for (std::size_t i = GetParam(); i < cases.size(); i += parts) {
    const Case& one = cases[i];
    const Shell shell;
    write_models(shell);
    const std::string line = crossing.line(one);
    SCOPED_TRACE("hmax " + line);
    const double start = child_seconds();
    const Told told = shell.hmax(line);
    seconds[crossing.command(one).name] += child_seconds() - start;
    ++codes[told.exit_code];
    expect_right(crossing, one, shell, told);
  }
  std::cout << child_seconds() - before << " s of CPU time;";
  // Refused is what does not suit and little else.
  EXPECT_GE(codes[0] + codes[1], codes[2]);
  for (const auto& [code, count] : codes) std::cout << " exit " << code << ": " << count << ";";
  for (const auto& [name, time] : seconds) std::cout << " " << name << " " << time << " s";
  std::cout << "\n";
}

}  // namespace
}  // namespace hmax
