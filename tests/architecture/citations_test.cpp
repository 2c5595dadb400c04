#include "tests/architecture/citations.hpp"

#include <gtest/gtest.h>

#include "tests/architecture/include_arrows.hpp"
#include "tests/architecture/source_tree.hpp"

namespace hmax::architecture {
namespace {

std::set<std::string> keys_in_references_bib() {
  return bibliography_keys(read_text(source_dir() / "references.bib"));
}

/// Every text in which a citation may stand; the tests themselves hold planted ones and are left out.
std::vector<std::string> citing_files() {
  std::vector<std::string> files{"README.md", "CONTRIBUTING.md"};
  std::vector<std::string> folders{"docs"};
  for (const auto& [folder, targets] : allowed_arrows)
    if (folder != "tests") folders.push_back(folder);
  for (const std::string& folder : folders) {
    const auto found = files_under(folder, {".hpp", ".cpp", ".md", ".toml", ".csv", ".json"});
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

TEST(Citations, EveryCitedKeyStandsInReferencesBib) {
  const auto known = keys_in_references_bib();
  for (const std::string& file : citing_files())
    for (const std::string& key : cited_keys(read_text(source_dir() / file)))
      EXPECT_TRUE(known.contains(key)) << file << " cites " << key << ", which references.bib does not have.";
}

TEST(Citations, EveryTableauNamesASourceInReferencesBib) {
  const auto known = keys_in_references_bib();
  std::size_t methods = 0, sourced = 0;
  for (const std::string& file : files_under("integrators", {".hpp"})) {
    if (!file.starts_with("integrators/explicit/tableaux")) continue;
    const std::string text = read_text(source_dir() / file);
    const auto count = [&](const char* pattern) {
      const std::regex regex(pattern);
      return static_cast<std::size_t>(
          std::distance(std::sregex_iterator(text.begin(), text.end(), regex), {}));
    };
    methods += count(R"(std::string_view id = ")");
    sourced += count(R"re(std::string_view id = "[a-z0-9_]+", source = "[^"]+";)re");
    for (const std::string& key : tableau_sources(text))
      EXPECT_TRUE(known.contains(key))
          << file << " names the source \"" << key << "\", which references.bib does not have.";
  }
  EXPECT_GT(methods, 0U);
  EXPECT_EQ(sourced, methods) << "a method has an id and no source";
}

TEST(Citations, EveryEntryOfReferencesBibIsCited) {
  std::set<std::string> cited;
  for (const std::string& file : citing_files()) cited.merge(cited_keys(read_text(source_dir() / file)));
  for (const std::string& key : keys_in_references_bib())
    EXPECT_TRUE(cited.contains(key)) << "nothing cites " << key << "; take it out of references.bib.";
}

TEST(Citations, APlantedCitationIsFoundInProseAndInData) {
  const std::string text =
      "/// [nobody1999nothing] and [nobody2001else, table 2]\n auto source = \"nobody2002data\"; a[i1999x2]";
  EXPECT_EQ(cited_keys(text),
            (std::set<std::string>{"nobody1999nothing", "nobody2001else", "nobody2002data"}));
  EXPECT_EQ(tableau_sources("id = \"x\", source = \"my notes\";"), (std::set<std::string>{"my notes"}));
  for (const std::string& key : cited_keys(text)) EXPECT_FALSE(keys_in_references_bib().contains(key));
}

TEST(Citations, KeysAreReadFromBibtex) {
  EXPECT_EQ(bibliography_keys("@book{a1990b,\n title={x}}\n@article{c1991d,\n}"),
            (std::set<std::string>{"a1990b", "c1991d"}));
}

}  // namespace
}  // namespace hmax::architecture
