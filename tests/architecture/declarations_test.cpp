#include "tests/architecture/declarations.hpp"

#include <map>

#include <gtest/gtest.h>

#include "tests/architecture/include_arrows.hpp"
#include "tests/architecture/source_tree.hpp"

namespace hmax::architecture {
namespace {

using Rooms = std::map<std::string, std::set<std::string>>;

/// What a source defines that headers of other rooms alone declare: such a header points up without an
/// include.
std::set<std::string> defined_elsewhere(const Rooms& declared, const std::string& room,
                                        const std::string& source) {
  std::set<std::string> found;
  for (const std::string& name : free_functions(source, true))
    if (const auto rooms = declared.find(name); rooms != declared.end() && !rooms->second.contains(room))
      found.insert(name);
  return found;
}

TEST(Declarations, StandInTheRoomThatDefinesThem) {
  Rooms declared;
  for (const auto& [room, targets] : allowed_arrows)
    if (room != "tests")
      for (const std::string& file : files_under(room, {".hpp"}))
        for (const std::string& name : free_functions(read_text(source_dir() / file), false))
          declared[name].insert(room);
  EXPECT_GT(declared.size(), 500U);
  for (const auto& [room, targets] : allowed_arrows)
    if (room != "tests")
      for (const std::string& file : files_under(room, {".cpp"}))
        for (const std::string& name : defined_elsewhere(declared, room, read_text(source_dir() / file)))
          ADD_FAILURE() << file << " defines " << name << ", which a header of " << *declared.at(name).begin()
                        << " declares.";
}

TEST(Declarations, ThatPointUpAreFound) {
  const std::string header =
      "namespace hmax {\nReference make_reference(const Problem& problem,\n                         double t_end);\n";
  const std::string source =
      "namespace hmax {\nnamespace {\nvoid hidden(int x) {\n}\n}  // namespace\nReference make_reference(const Problem& problem,\n"
      "                         double t_end) {\n  return run(problem);\n}\n";
  EXPECT_EQ(free_functions(header, false), std::set<std::string>{"hmax::make_reference"});
  EXPECT_EQ(free_functions(source, true), std::set<std::string>{"hmax::make_reference"});
  EXPECT_EQ(defined_elsewhere({{"hmax::make_reference", {"catalogue"}}}, "bench", source),
            std::set<std::string>{"hmax::make_reference"});
  EXPECT_EQ(defined_elsewhere({{"hmax::make_reference", {"bench"}}}, "bench", source),
            std::set<std::string>{});
}

}  // namespace
}  // namespace hmax::architecture
