/// Links of Markdown pages, and the headings that they may point to.
#pragma once

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/architecture/source_tree.hpp"

namespace hmax::architecture {

/// The lines of a page outside of fenced blocks.
inline std::vector<std::string> prose_lines(const std::string& markdown) {
  std::vector<std::string> lines;
  std::istringstream stream(markdown);
  bool fenced = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.find_first_not_of(' ') != std::string::npos &&
        line.substr(line.find_first_not_of(' ')).starts_with("```"))
      fenced = !fenced;
    else if (!fenced)
      lines.push_back(line);
  }
  return lines;
}

/// Targets of the links and images of a page, `path`, `path#anchor` or `#anchor`, without those on other
/// hosts. A link may go over two lines.
inline std::set<std::string> relative_links(const std::string& markdown) {
  std::string prose;
  for (const std::string& line : prose_lines(markdown)) prose += line + "\n";
  prose = std::regex_replace(prose, std::regex("`[^`\n]*`"), "code");
  static const std::regex link(R"(\]\(([^)\s]+)\))"), absolute("^[a-z]+:");
  std::set<std::string> links;
  for (std::sregex_iterator it(prose.begin(), prose.end(), link), end; it != end; ++it)
    if (const std::string target = (*it)[1]; !std::regex_search(target, absolute)) links.insert(target);
  return links;
}

/// The anchor that GitHub gives a heading: lower case, blanks as hyphens, of other signs only - and _.
inline std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : std::regex_replace(heading, std::regex(R"(\[([^\]]*)\]\([^)]*\))"), "$1")) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == ' ')
      anchor += '-';
    else if (std::isalnum(byte) || c == '-' || c == '_' || byte >= 0x80)
      anchor += static_cast<char>(std::tolower(byte));
  }
  return anchor;
}

/// Anchors of all headings of a page; a heading that occurs again has -1, -2, ... behind its anchor.
inline std::set<std::string> anchors_of(const std::string& markdown) {
  static const std::regex heading(R"(^#{1,6} +(.*?) *$)");
  std::set<std::string> anchors;
  std::map<std::string, int> times;
  for (const std::string& line : prose_lines(markdown))
    if (std::smatch match; std::regex_match(line, match, heading)) {
      const std::string anchor = anchor_of(match[1]);
      const int before = times[anchor]++;
      anchors.insert(before ? anchor + "-" + std::to_string(before) : anchor);
    }
  return anchors;
}

/// Links of `page` (relative to the project) whose file or heading does not exist.
inline std::vector<std::string> broken_links(const std::string& page, const std::string& markdown) {
  std::vector<std::string> broken;
  for (const std::string& link : relative_links(markdown)) {
    const auto hash = link.find('#');
    const std::string path = link.substr(0, hash);
    const std::filesystem::path file =
        path.empty() ? source_dir() / page : (source_dir() / page).parent_path() / path;
    const bool found = path.empty() || std::filesystem::exists(file);
    if (!found || (hash != std::string::npos &&
                   !anchors_of(path.empty() ? markdown : read_text(file)).contains(link.substr(hash + 1))))
      broken.push_back(link);
  }
  return broken;
}

/// Every Markdown page of the project; hidden folders, builds and stored runs are left out.
inline std::vector<std::string> markdown_pages() {
  namespace fs = std::filesystem;
  std::vector<std::string> pages;
  for (fs::recursive_directory_iterator it(source_dir()), end; it != end; ++it) {
    const std::string file = fs::relative(it->path(), source_dir()).generic_string();
    const bool hidden = it->path().filename().string().starts_with(".");
    if (it->is_directory() && (hidden || file.starts_with("build") || file == "results/runs"))
      it.disable_recursion_pending();
    else if (it->is_regular_file() && it->path().extension() == ".md")
      pages.push_back(file);
  }
  std::sort(pages.begin(), pages.end());
  return pages;
}

/// Pages below docs/ that a text names by their path from the root of the project, as comments and messages
/// do.
inline std::set<std::string> named_pages(const std::string& text) {
  static const std::regex path(R"(docs/[a-z_/]+\.md)");
  std::set<std::string> pages;
  for (std::size_t i = 0; (i = text.find("docs/", i)) != std::string::npos; ++i) {
    const char before = i ? text[i - 1] : ' ';
    if (std::isalnum(static_cast<unsigned char>(before)) ||
        std::string("_./").find(before) != std::string::npos)
      continue;
    if (std::smatch match; std::regex_search(text.begin() + static_cast<std::ptrdiff_t>(i), text.end(), match,
                                             path, std::regex_constants::match_continuous))
      pages.insert(match[0]);
  }
  return pages;
}

}  // namespace hmax::architecture
