/// Keys of references.bib, and the places in a text that cite them.
#pragma once

#include <cstddef>
#include <regex>
#include <set>
#include <string>

namespace hmax::architecture {

namespace detail {
inline std::set<std::string> captures(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it) found.insert((*it)[1]);
  return found;
}
}  // namespace detail

/// The keys defined by a BibTeX file.
inline std::set<std::string> bibliography_keys(const std::string& bibtex) {
  return detail::captures(bibtex, R"((?:^|\n)@[a-z]+\{([^,\s]+),)");
}

/// The keys a text cites: [name1999word] and [name1999word, section 2] in prose, and the same shape as a
/// string of data.
inline std::set<std::string> cited_keys(const std::string& text) {
  static const std::regex key(R"re(\[([a-z]+[12][0-9]{3}[a-z]+)[\],;: ]|"([a-z]+[12][0-9]{3}[a-z]+)")re");
  std::set<std::string> keys;
  for (std::size_t i = 0; (i = text.find_first_of("[\"", i)) != std::string::npos; ++i)
    if (std::smatch match; std::regex_search(text.begin() + static_cast<std::ptrdiff_t>(i), text.end(), match,
                                             key, std::regex_constants::match_continuous))
      keys.insert(match[1].matched ? match[1] : match[2]);
  return keys;
}

/// What stands behind `source = ` in a header of tableaux, whatever its shape.
inline std::set<std::string> tableau_sources(const std::string& text) {
  return detail::captures(text, R"re(\bsource = "([^"]*)")re");
}

}  // namespace hmax::architecture
