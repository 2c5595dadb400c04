/// The commands of the README and of the pages of docs/ are run, and print what the pages show. With
/// HMAX_UPDATE_PAGES=1 in the environment what a page shows is replaced by what its command prints.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/numbers.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

/// A command and the output that a page shows: that of a line `$ COMMAND` in a ```console block, or, as a
/// list of options, that of a line `<!-- hmax COMMAND --help -->` or `<!-- hmax COMMAND --help, GROUP -->`.
struct Shown {
  std::string command, output;
  std::string group = "Options";
  bool is_list = false;
  std::size_t begin = 0, end = 0;  ///< lines of the page
};

/// What a page asks its reader to type: files, as blocks that begin with ```toml NAME or ```mtx NAME, and
/// commands.
struct Page {
  std::vector<std::string> lines;
  std::vector<std::pair<std::string, std::string>> files;  // name, text
  std::vector<Shown> shown;
};

Page read_page(const std::string& text) {
  Page page;
  std::istringstream lines(text);
  enum { outside, console, list, file, other } inside = outside;
  const std::string comment = "<!-- hmax ", comment_end = " -->";
  for (std::string line; std::getline(lines, line);) {
    page.lines.push_back(line);
    const std::size_t next = page.lines.size();
    if (line.rfind("```", 0) == 0) {
      const bool begins_file = line.starts_with("```toml ") || line.starts_with("```mtx ");
      if (inside != outside)
        inside = outside;
      else
        inside = line == "```console" ? console : begins_file ? file : other;
      if (inside == file) page.files.emplace_back(line.substr(line.find(' ') + 1), "");
    } else if (inside == console && line.rfind("$ ", 0) == 0) {
      page.shown.push_back({line.substr(2), "", "Options", false, next, next});
    } else if (inside == outside && line.rfind(comment, 0) == 0 && line.ends_with(comment_end)) {
      inside = list;
      const std::size_t begin = comment.find("hmax");
      const std::string command = line.substr(begin, line.size() - begin - comment_end.size());
      const std::size_t comma = command.find(", ");
      page.shown.push_back({command.substr(0, comma), "",
                            comma == std::string::npos ? "Options" : command.substr(comma + 2), true, next,
                            next});
    } else if (inside == list && line.empty()) {
      inside = outside;
    } else if ((inside == console || inside == list) && !page.shown.empty()) {
      page.shown.back().output += line + "\n";
      page.shown.back().end = next;
    } else if (inside == file) {
      page.files.back().second += line + "\n";
    }
  }
  return page;
}

/// An item of a list of options, of "--h NUMBER", "Step size [s]; 0.1 by default". The parser shows its own
/// defaults as NUMBER=0.1; NAME=VALUE is the form of a value.
std::string option_item(std::string option, std::string meaning) {
  std::string fallback;
  std::smatch found;
  if (option.ends_with(" ...")) option.resize(option.size() - 4);
  if (std::regex_match(option, found, std::regex("(.*) REQUIRED"))) {
    option = found[1].str();
    fallback = "required";
  } else if (std::regex_match(option, found, std::regex("([^=]*)=([^=A-Z][^=]*)"))) {
    fallback = "`" + found[2].str() + "`";
    option = found[1].str();
  }
  if (std::regex_match(meaning, found, std::regex("(.*); ([^;]*[^;,]),? by default"))) {
    fallback = found[2];
    meaning = found[1].str();
  }
  return "- `" + option + "`" + (fallback.empty() ? "" : " (" + fallback + ")") + ": " + meaning + "\n";
}

/// A group of the options in the help of a command as a list of "- `OPTION` (DEFAULT): meaning"; that of
/// "Options" has the arguments, too. Every command has --help and --json, which are left out.
std::string option_list(const std::string& help, const std::string& group = "Options") {
  std::string list;
  std::istringstream lines(help);
  bool inside = false;
  std::string option;
  const std::regex entry(R"(  (\S.*?)(   *(\S.*))?)"), continued(R"(    +(\S.*))");
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (!line.starts_with("  ")) {
      // Groups of a command's own are among its options; those of many commands have a page of their own.
      const bool is_shared = line == "Model:" || line == "Common:";
      const bool is_own = line.ends_with(':') && !line.starts_with("Example") && line != "Subcommands:";
      inside = group == "Options" ? is_own && !is_shared : line == group + ":";
    } else if (inside && std::regex_match(line, found, continued)) {
      list += option_item(option, found[1]);
    } else if (inside && std::regex_match(line, found, entry)) {
      option = found[1];
      std::string meaning = found[3];
      // A name that leaves one space before the column of meanings.
      constexpr std::size_t column = 30;
      if (meaning.empty() && line.size() > column && line[column - 1] == ' ' && line[column - 2] != ' ') {
        option = line.substr(2, column - 3);
        meaning = line.substr(column);
      }
      // An argument may be given as an option, too.
      const std::string name = option.substr(0, option.find_first_of(" ,"));
      const bool repeats =
          name.starts_with("--") && list.find("- `" + name.substr(2) + " ") != std::string::npos;
      if (!meaning.empty() && option != "-h,--help" && option != "--json" && !repeats)
        list += option_item(option, meaning);
    }
  }
  return list;
}

/// Words of a text; the time after "cpu" and the real-time "factor" are left out, they differ from run to
/// run.
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; stream >> word;)
    words.push_back(!words.empty() && (words.back() == "cpu" || words.back() == "factor") ? "TIME" : word);
  return words;
}

/// Equal words; numbers may differ in the digits that another machine's cosine changes.
bool alike(const std::string& told, const std::string& shown) {
  const std::vector<std::string> a = words_of(told), b = words_of(shown);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const std::string& x, const std::string& y) {
    if (x == y) return true;
    const auto left = to_number(x), right = to_number(y);
    return left && right && std::abs(*left - *right) <= 1e-6 * std::abs(*right);
  });
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// Whether what a command prints depends on the machine: which method is fastest does. Only the first line is
/// compared, which stands behind a first answer where the machine is slow.
bool measures(const std::string& command) {
  return command.starts_with("hmax sweep") || command.starts_with("hmax precision") ||
         command.starts_with("hmax advise");
}

bool is_as_shown(const std::string& told, const Shown& shown) {
  if (!measures(shown.command) || shown.is_list || told.empty()) return alike(told, shown.output);
  const std::string head = first_line(shown.output);
  return std::ranges::any_of(lines_of(told), [&](const std::string& line) { return alike(line, head); });
}

/// Writes a page with `outputs` in the places of what it shows.
void write_page(const std::filesystem::path& path, const Page& page,
                const std::vector<std::string>& outputs) {
  std::ofstream file(path);
  std::size_t line = 0;
  for (std::size_t i = 0; i < page.shown.size(); ++i) {
    for (; line < page.shown[i].begin; ++line) file << page.lines[line] << "\n";
    file << outputs[i];
    line = page.shown[i].end;
  }
  for (; line < page.lines.size(); ++line) file << page.lines[line] << "\n";
}

/// Runs the commands of a page in a folder of its own.
/// @return how many there are
std::size_t run_page(const std::filesystem::path& path) {
  SCOPED_TRACE(path.string());
  const Page page = read_page(read_text(path));
  const Shell shell;
  for (const auto& [name, text] : page.files) std::ofstream(shell / name) << text;
  std::vector<std::string> outputs;
  bool changed = false;
  for (const Shown& shown : page.shown) {
    SCOPED_TRACE(shown.command);
    const Told told = shell.line(shown.command);
    EXPECT_EQ(told.err, "");
    const std::string output = shown.is_list ? option_list(told.out, shown.group) : told.out;
    const bool same = is_as_shown(output, shown);
    outputs.push_back(same ? shown.output : output);
    changed = changed || !same;
    EXPECT_TRUE(same) << output;
  }
  if (changed && std::getenv("HMAX_UPDATE_PAGES")) write_page(path, page, outputs);
  return page.shown.size();
}

/// Runs every page of a folder of docs/.
std::size_t run_pages(const std::string& folder) {
  std::size_t commands = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(HMAX_SOURCE_DIR) / "docs" / folder))
    if (entry.path().extension() == ".md") commands += run_page(entry.path());
  return commands;
}

TEST(Readme, EveryCommandPrintsWhatIsShown) {
  EXPECT_GE(run_page(std::filesystem::path(HMAX_SOURCE_DIR) / "README.md"), 1U);
}

TEST(Readme, EveryCommandOfTheTutorialPrintsWhatIsShown) { EXPECT_GE(run_pages("tutorial"), 15U); }

TEST(Readme, EveryCommandOfTheHowToPagesPrintsWhatIsShown) { EXPECT_GE(run_pages("howto"), 10U); }

TEST(Readme, EveryCommandAndOptionListOfTheReferencePrintsWhatIsShown) {
  EXPECT_GE(run_pages("reference/commands"), 40U);
}

std::filesystem::path reference() { return std::filesystem::path(HMAX_SOURCE_DIR) / "docs/reference"; }

/// A page that describes a group of options once for all commands.
struct SharedGroup {
  std::string title, page, link;
};
const std::vector<SharedGroup> shared_groups{{"Model", "model_options.md", "../model_options.md"},
                                             {"Common", "cli.md", "../cli.md#common-options"}};

TEST(Readme, OptionsOfManyCommandsStandOnOnePage) {
  for (const SharedGroup& group : shared_groups) EXPECT_GE(run_page(reference() / group.page), 1U);
  std::size_t commands_with_models = 0;
  const Shell shell;
  for (const auto& entry : std::filesystem::directory_iterator(reference() / "commands")) {
    const std::string page = read_text(entry.path());
    for (const Shown& shown : read_page(page).shown) {
      if (!shown.is_list) continue;
      const std::string help = shell.line(shown.command).out;
      for (const SharedGroup& group : shared_groups) {
        const std::string described = read_text(reference() / group.page);
        const std::vector<std::string> rows = lines_of(option_list(help, group.title));
        for (const std::string& row : rows)
          EXPECT_TRUE(says(described, row))
              << shown.command << " has an option that " << group.page << " lacks: ";
        EXPECT_TRUE(rows.empty() || page.find(group.link) != std::string::npos)
            << entry.path() << " does not link to " << group.link;
        if (!rows.empty() && group.title == "Model") ++commands_with_models;
      }
    }
  }
  EXPECT_GE(commands_with_models, 10U);
}

TEST(Readme, OptionsOfHelpBecomeAList) {
  const std::string help =
      "Integrate\nUsage: hmax run [OPTIONS]\n\nPositionals:\n  store REQUIRED   Its file\n"
      "  mesh TEXT   A file\n\nOptions:\n  --mesh TEXT   A file\n"
      "  -h,--help   Help\n  --h NUMBER   Step size [s]; 0.1 by default\n  --long-name TEXT=a|b\n"
      "                              Two lines\n  --set NAME=VALUE ...   Set\n\nExample:\n  hmax run\n";
  const std::string list = option_list(help);
  EXPECT_EQ(list,
            "- `store` (required): Its file\n- `mesh TEXT`: A file\n- `--h NUMBER` (0.1): Step size [s]\n"
            "- `--long-name TEXT` (`a|b`): Two lines\n- `--set NAME=VALUE`: Set\n");
  const std::string grouped = "Options:\n  --a   One\n\nModel:\n  --b NAME   Two\n\nExample:\n  hmax run\n";
  EXPECT_EQ(lines_of(option_list(grouped)), std::vector<std::string>{"- `--a`: One"});
  EXPECT_EQ(lines_of(option_list(grouped, "Model")), std::vector<std::string>{"- `--b NAME`: Two"});
  EXPECT_EQ(read_page("<!-- hmax run --help, Model -->\n- b\n").shown.at(0).group, "Model");
  const Page page = read_page("<!-- hmax run --help -->\n- a\n\n- b\n");
  ASSERT_EQ(page.shown.size(), 1U);
  EXPECT_EQ(page.shown[0].command, "hmax run --help");
  EXPECT_EQ(page.shown[0].output, "- a\n");
  EXPECT_FALSE(is_as_shown(list, page.shown[0]));
}

TEST(Readme, AWrongOutputWouldBeNoticed) {
  const Page page = read_page("```console\n$ hmax --version\nhmax 99\n```\n");
  ASSERT_EQ(page.shown.size(), 1U);
  EXPECT_FALSE(alike(Shell().line(page.shown[0].command).out, page.shown[0].output));
  EXPECT_FALSE(alike("x 1.00001", "x 1"));
  EXPECT_TRUE(alike("cpu 1 s", "cpu 2 s"));
}

TEST(Readme, BlocksThatAreFilesAreReadAsFiles) {
  const Page page =
      read_page("```toml a.toml\n$ b = 1\n```\n```\n$ hmax\n```\n```console\n$ cat a.toml\n$ b = 1\n```\n");
  ASSERT_EQ(page.files.size(), 1U);
  EXPECT_EQ(page.files[0].first, "a.toml");
  EXPECT_EQ(page.files[0].second, "$ b = 1\n");
  ASSERT_EQ(page.shown.size(), 2U);
  EXPECT_EQ(page.shown[0].command, "cat a.toml");
}

}  // namespace
}  // namespace hmax
