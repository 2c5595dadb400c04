/// Links of written pages of HTML.
#pragma once

#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/results/scratch.hpp"

namespace hmax {

/// A page without its pictures, whose texts have links and ids of their own.
inline std::string without_pictures(std::string page) {
  const std::string opening = " src=";
  for (std::size_t at = 0; (at = page.find(opening, at)) != std::string::npos;) {
    const std::size_t begin = at + opening.size();
    page.erase(at, page.find(page[begin], begin + 1) + 1 - at);
  }
  return page;
}

/// The values of an attribute.
inline std::set<std::string> values_of(const std::string& page, const std::string& attribute) {
  std::set<std::string> values;
  const std::string opening = " " + attribute + "=\"";
  for (std::size_t at = page.find(opening); at != std::string::npos; at = page.find(opening, at + 1)) {
    const std::size_t begin = at + opening.size();
    values.insert(page.substr(begin, page.find('"', begin) - begin));
  }
  return values;
}

/// Links that lead to no file or to no id, as "page: link". Those to other hosts are left out, and so are
/// those to rows, which a script makes.
/// @param links  counts the links that were followed
inline std::vector<std::string> broken_html_links(const std::filesystem::path& folder, std::size_t& links) {
  namespace fs = std::filesystem;
  static const std::regex elsewhere("^[a-z]+:"), row("^(rows|limits|advice)-[0-9-]+$");
  std::vector<std::string> broken;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".html") continue;
    for (const std::string& link : values_of(without_pictures(read_text(entry.path())), "href")) {
      const std::size_t hash = link.find('#');
      const std::string path = link.substr(0, hash),
                        id = hash == std::string::npos ? "" : link.substr(hash + 1);
      if (std::regex_search(link, elsewhere) || std::regex_search(id, row)) continue;
      ++links;
      const fs::path target = path.empty() ? entry.path() : entry.path().parent_path() / path;
      if (!fs::exists(target) ||
          (!id.empty() && !values_of(without_pictures(read_text(target)), "id").contains(id)))
        broken.push_back(entry.path().string() + ": " + link);
    }
  }
  return broken;
}

/// No page leads nowhere, and none is larger than it may be.
inline void expect_whole_pages(const std::filesystem::path& folder, std::size_t least_links) {
  std::size_t links = 0;
  for (const std::string& broken : broken_html_links(folder, links)) ADD_FAILURE() << broken;
  EXPECT_GE(links, least_links);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".html") {
      EXPECT_LE(entry.file_size(), 5'000'000U) << entry.path();
    }
}

}  // namespace hmax
