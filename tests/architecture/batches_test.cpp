/// Sources that are compiled in one batch: which they are changes with every new file.
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/architecture/declarations.hpp"
#include "tests/architecture/include_arrows.hpp"
#include "tests/architecture/source_tree.hpp"
#include "tests/says.hpp"

namespace hmax::architecture {
namespace {

struct Place {
  std::string file;
  Declared what;
};
using Places = std::vector<Place>;

void add(const std::string& file, const std::vector<Declared>& declared, Places& places) {
  for (const Declared& what : declared) places.push_back({file, what});
}

/// Whether one call may mean both functions: what one has more has defaults, or any number is taken.
bool take_the_same(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    const std::string_view first = a.substr(0, a.find(';')), other = b.substr(0, b.find(';'));
    if (first.ends_with("...") || other.ends_with("...")) return true;
    if (first.substr(0, first.find('=')) != other.substr(0, other.find('='))) return false;
    a.remove_prefix(first.size() + 1);
    b.remove_prefix(other.size() + 1);
  }
  const std::string_view more = a.substr(0, a.find(';')), other = b.substr(0, b.find(';'));
  return (more.empty() || more.ends_with('=')) && (other.empty() || other.ends_with('='));
}

bool collide(const Declared& a, const Declared& b) {
  if (a.meaning.starts_with('(') && b.meaning.starts_with('('))
    return take_the_same(a.meaning.substr(1), b.meaning.substr(1));
  if (a.meaning.starts_with('=') && b.meaning.starts_with('=')) return a.meaning != b.meaning;
  return true;
}

/// Names in anonymous namespaces that another file has too.
std::vector<std::string> collisions(const Places& places) {
  std::map<std::string, std::vector<const Place*>> by_name;
  std::vector<std::string> found;
  for (const Place& place : places) {
    auto& others = by_name[place.what.name];
    for (const Place* other : others)
      if (other->file != place.file && (other->what.hidden || place.what.hidden) &&
          collide(other->what, place.what))
        found.push_back(place.what.name + " of " + other->file + " and " + place.file);
    others.push_back(&place);
  }
  return found;
}

/// The room whose target compiles a source in batches: "limits" or "tests/limits"; empty where it is compiled
/// alone.
std::string room_of_batches(const std::string& file) {
  for (const char* alone : {"/kernels/", "/micro/", "no_malloc_test", "/odeint/", "/sundials/"})
    if (says(file, alone)) return "";
  const std::string folder = folder_of(file);
  if (folder == "tests") return file.ends_with("_test.cpp") ? file.substr(0, file.find('/', 6)) : "";
  return says(read_text(source_dir() / folder / "CMakeLists.txt"), "hmax_unity(") ? folder : "";
}

/// Headers of the room itself and of those that it includes.
bool may_see(const std::string& room, const std::string& header) {
  const bool of_tests = room.starts_with("tests/");
  const auto arrows = allowed_arrows.find(of_tests ? room.substr(6) : room);
  return (arrows != allowed_arrows.end() && arrows->second.contains(folder_of(header))) ||
         (of_tests && header.starts_with(room + "/"));
}

TEST(Batches, NamesInAnonymousNamespacesAreThoseOfOneFile) {
  std::map<std::string, Places> rooms;
  for (const auto& [folder, targets] : allowed_arrows)
    for (const std::string& file : files_under(folder, {".cpp"}))
      if (const std::string room = room_of_batches(file); !room.empty())
        add(file, declared_in(read_text(source_dir() / file)), rooms[room]);
  EXPECT_GT(rooms.size(), 20U);
  for (const auto& [folder, targets] : allowed_arrows)
    for (const std::string& header : files_under(folder, {".hpp"})) {
      const auto declared = declared_in(read_text(source_dir() / header));
      for (auto& [room, places] : rooms)
        if (may_see(room, header)) add(header, declared, places);
    }
  for (const auto& [room, places] : rooms)
    for (const std::string& collision : collisions(places))
      ADD_FAILURE() << collision << ": one batch may hold both.";
}

TEST(Batches, ANameOfTwoFilesIsFound) {
  const auto found = [](const std::string& one, const std::string& other, bool shown = false) {
    Places places;
    const auto hidden = [](const std::string& text) {
      return "namespace {\n" + text + "\n}  // namespace\n";
    };
    add("a.cpp", declared_in("namespace hmax {\n" + hidden(one)), places);
    add("b", declared_in("namespace hmax {\n" + (shown ? other : hidden(other))), places);
    return collisions(places).size();
  };
  EXPECT_EQ(found("enum class Root { low, high };", "struct Root : Place {\n  int x;\n};"), 1U);
  EXPECT_EQ(found("struct Root;", "struct Root {};"), 0U);
  EXPECT_EQ(found("using One = Vector<double>;", "using One = Vector<float>;"), 1U);
  EXPECT_EQ(found("using One = Vector<double>;", "using One = Vector<double>;"), 0U);
  EXPECT_EQ(found("using Eigen::Index;", "using Index = TetMesh::Index;"), 1U);
  EXPECT_EQ(found("using Eigen::Index;", "using Index = Eigen::Index;"), 0U);
  EXPECT_EQ(found("constexpr double many[] = {1,\n  2};", "const Plane many(0, 1);  // of them"), 1U);
  EXPECT_EQ(
      found("template <class T>\nstd::map<T, int> f(const A& a,\n    int b = g(1, 2)) {\n  return {};\n}",
            "template <class T>\nvoid f(const A&, int c) {}"),
      1U);
  EXPECT_EQ(found("void f(int a) {\n}", "void f(double a) {\n}"), 0U);
  EXPECT_EQ(found("void f(const std::string& a) {\n}", "void f(std::string_view a) {\n}"), 1U);
  EXPECT_EQ(found("void f(int a) {\n}", "void f(int a, std::map<A, B> b = {}) {\n}"), 1U);
  EXPECT_EQ(found("void f(int a) {\n}", "void f(int a, std::map<A, B> b) {\n}"), 0U);
  EXPECT_EQ(found("struct Settled {\n};", "struct Settled {\n};", true), 1U);
  EXPECT_EQ(found("void f(int a) {\n}", "void f(int b);", true), 1U);
  EXPECT_EQ(found("[[noreturn]] void f(int a) {\n}", "void f(int b) {\n}"), 1U);
  EXPECT_EQ(found("void f(int a) {\n}", "namespace detail {\n}  // namespace detail\nvoid f(int b);", true),
            1U);
  EXPECT_EQ(found("void f(int a) {\n}", "namespace detail {\nvoid f(int b);\n}  // namespace detail", true),
            0U);
  EXPECT_EQ(found("void f(int a) {\n}", "template <class... T>\nvoid f(T&&... b) {}", true), 1U);
}

}  // namespace
}  // namespace hmax::architecture
