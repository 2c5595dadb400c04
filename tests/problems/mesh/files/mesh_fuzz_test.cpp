/// Files that were cut off or damaged anywhere: every one is refused in a sentence or read as a mesh whose
/// indices and numbers can be relied on, and none makes the readers ask for memory that it does not fill.
/// Files that have lost something, or have it twice, are refused or read as the mesh of the whole file.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <new>
#include <stdexcept>

#include <gtest/gtest.h>

#include "problems/mesh/files/mesh_defects.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"

#if !defined(__SANITIZE_ADDRESS__)
namespace {
std::atomic<std::size_t> largest_request{0};
}  // namespace

// Keeps the size of the largest request of this program.
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (size > largest_request.load(std::memory_order_relaxed)) largest_request = size;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace hmax {
namespace {

/// True when the damaged file was refused.
bool refused(const GoldenMesh& damaged) {
  try {
    MeshFile file = damaged.read();
    const auto points = static_cast<int>(file.mesh.point_count());
    EXPECT_GT(file.mesh.tetrahedron_count(), 0);
    EXPECT_TRUE(file.mesh.points.allFinite());
    EXPECT_GE(file.mesh.tetrahedra.minCoeff(), 0);
    EXPECT_LT(file.mesh.tetrahedra.maxCoeff(), points);
    EXPECT_EQ(file.numbers.size(), file.places.size());
    EXPECT_EQ(static_cast<int>(file.point_numbers.size()), points);
    for (const MeshGroup& group : file.groups) {
      EXPECT_EQ(group.corners.size() % static_cast<std::size_t>(group.dimension + 1), 0U);
      for (const TetMesh::Index corner : group.corners) EXPECT_TRUE(corner >= 0 && corner < points);
    }
    const MeshDefects defects = defects_of(file.mesh);
    if (!defects.none()) return false;
    EXPECT_GT(import_mesh(file, 1).mesh.tetrahedron_count(), 0);
    return false;
  } catch (const std::invalid_argument& error) {
    const std::string sentence = error.what();
    EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
    EXPECT_TRUE(sentence.starts_with(damaged.name) || sentence.starts_with(damaged.ele_name)) << sentence;
    return true;
  }
}

/// All that a mesh file tells, but for the lines at which it tells it.
bool same_mesh(const MeshFile& a, const MeshFile& b) {
  const auto same_group = [](const MeshGroup& x, const MeshGroup& y) {
    return x.dimension == y.dimension && x.number == y.number && x.name == y.name && x.corners == y.corners;
  };
  return a.mesh.points == b.mesh.points && a.mesh.tetrahedra == b.mesh.tetrahedra &&
         a.mesh.regions == b.mesh.regions && a.numbers == b.numbers && a.point_numbers == b.point_numbers &&
         a.names == b.names && a.second_order == b.second_order && a.triangles == b.triangles &&
         std::ranges::equal(a.groups, b.groups, same_group);
}

void expect_refused_or_same(const GoldenMesh& damaged, const MeshFile& whole, const std::string& what) {
  try {
    EXPECT_TRUE(same_mesh(damaged.read(), whole)) << what << " is read as another mesh";
  } catch (const std::invalid_argument&) {
  }
}

/// Calls use(where it begins, itself) for each piece of a text up to and with one of `ends`.
template <class Use>
void for_pieces(const std::string& text, const char* ends, Use use) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find_first_of(ends, begin), text.size() - 1) + 1;
    use(begin, text.substr(begin, end - begin));
    begin = end;
  }
}

/// Both parts of a mesh, damaged one after the other by damage(text, try_it).
template <class Damage>
void expect_refusals(const GoldenMesh& golden, Damage damage) {
  SCOPED_TRACE(golden.name);
  const MeshFile whole = golden.read();
  GoldenMesh damaged = golden;
  for (std::string* part : {&damaged.text, &damaged.ele_text}) {
    const std::string before = *part;
    damage(before, [&](const std::string& text, const std::string& what) {
      *part = text;
      expect_refused_or_same(damaged, whole, what);
      refused(damaged);
    });
    *part = before;
  }
}

/// Legacy VTK and Vega mark no end, and what follows the cells or elements need not be there: what is cut off
/// at the head of such a section is a whole file.
bool is_whole(const GoldenMesh& golden, const std::string& text, std::size_t size) {
  if (!golden.name.ends_with(".vtk") && !golden.name.ends_with(".veg")) return false;
  const std::size_t next = std::min(text.find_first_not_of('\n', size), text.size());
  const bool binary = text.find('\0') != std::string::npos;
  return (binary || (size > 0 && text[size - 1] == '\n')) &&
         std::ranges::any_of(
             std::array{"POINT_DATA", "CELL_DATA", "point_data", "Cell_Data", "*MATERIAL", "*SET", "*REGION"},
             [&](const char* head) { return text.substr(next).starts_with(head); });
}

TEST(DamagedMeshFiles, CutOffAnywhereTheyAreRefusedOrWhole) {
  for (const GoldenMesh& golden : golden_meshes())
    expect_refusals(golden, [&](const std::string& text, auto try_it) {
      for (std::size_t size = 0; size < text.size(); ++size)
        if (!is_whole(golden, text, size)) try_it(text.substr(0, size), "cut at " + std::to_string(size));
    });
}

TEST(DamagedMeshFiles, WithAWordLostOrALineLostOrTwiceTheyAreRefusedOrWhole) {
  for (const GoldenMesh& golden : golden_meshes())
    expect_refusals(golden, [&](const std::string& text, auto try_it) {
      const auto lose = [&](std::size_t begin, const std::string& piece) {
        try_it(std::string(text).erase(begin, piece.size()),
               "without '" + piece + "' at " + std::to_string(begin));
      };
      for_pieces(text, " \n", lose);
      for_pieces(text, "\n", [&](std::size_t begin, const std::string& line) {
        lose(begin, line);
        try_it(std::string(text).insert(begin, line), "twice '" + line + "' at " + std::to_string(begin));
      });
    });
}

TEST(DamagedMeshFiles, WithEightBytesLostAnywhereTheBinaryOnesAreRefusedOrWhole) {
  for (const GoldenMesh& golden : golden_meshes()) {
    if (golden.text.find('\0') == std::string::npos) continue;
    expect_refusals(golden, [&](const std::string& text, auto try_it) {
      for (std::size_t begin = 0; begin + 8 <= text.size(); ++begin)
        try_it(std::string(text).erase(begin, 8), "without 8 bytes at " + std::to_string(begin));
    });
  }
}

/// The parts of a binary file that hold raw values, between the texts around them.
std::vector<std::pair<std::size_t, std::size_t>> raw_parts(const std::string& text) {
  std::vector<std::pair<std::size_t, std::size_t>> parts;
  const auto between = [&](const std::string& head, const std::string& tail) {
    const std::size_t begin = text.find(head);
    if (begin == std::string::npos) return;
    const std::size_t end = text.find(tail, begin + head.size());
    EXPECT_NE(end, std::string::npos) << tail;
    if (end != std::string::npos) parts.emplace_back(begin + head.size(), end);
  };
  if (text.starts_with("$MeshFormat")) {
    for (const std::string section : {"Nodes", "Elements", "Entities"})
      between(
          "$" + section +
              (text.find("\n2.2 1") != std::string::npos ? (section == "Nodes" ? "\n5\n" : "\n3\n") : "\n"),
          "\n$End" + section);
  } else if (text.starts_with("# vtk")) {
    const bool older = text.find("OFFSETS") == std::string::npos;
    between("POINTS 5 float\n", older ? "\nCELLS" : "\nMETADATA");
    between("CELLS 2 10\n", "\nCELL_TYPES");
    between("OFFSETS vtktypeint64\n", "\nCONNECTIVITY");
    between("CONNECTIVITY vtktypeint64\n", "\nCELL_TYPES");
    between("CELL_TYPES 2\n", "\nPOINT_DATA");
    between("LOOKUP_TABLE default\n", "\nCELL_DATA");
    between("quality 1 2 double\n", "\nregion");
    parts.emplace_back(text.find("region 1 2 int\n") + 15, text.size() - 1);
  } else {
    const std::size_t begin = text.find('_', text.find("encoding=\"raw\""));
    parts.emplace_back(begin + 1, text.find("\n</AppendedData>"));
  }
  return parts;
}

TEST(DamagedMeshFiles, WithOneByteLostFromTheirValuesTheBinaryOnesAreRefused) {
  int tried = 0;
  for (const GoldenMesh& golden : golden_meshes()) {
    if (golden.text.find('\0') == std::string::npos) continue;
    SCOPED_TRACE(golden.name);
    for (const auto& [begin, end] : raw_parts(golden.text))
      for (std::size_t lost = begin; lost < end; ++lost, ++tried) {
        GoldenMesh damaged = golden;
        damaged.text.erase(lost, 1);
        EXPECT_THROW(static_cast<void>(damaged.read()), std::invalid_argument) << "byte " << lost;
      }
  }
  EXPECT_GT(tried, 2000);
}

TEST(DamagedMeshFiles, WithAWrongByteAnywhereTheyAreRefusedOrValid) {
  for (const GoldenMesh& golden : golden_meshes()) {
    SCOPED_TRACE(golden.name);
    for (std::size_t i = 0; i < golden.text.size(); ++i)
      for (const char byte : {'5', '6', '9', '-', ' ', '\n', '<', '\0', '\x7f', '\xff', 'e'}) {
        GoldenMesh damaged = golden;
        damaged.text[i] = byte;
        refused(damaged);
      }
    for (std::size_t i = 0; i < golden.ele_text.size(); ++i)
      for (const char byte : {'9', '-', ' ', '\0', '\xff'}) {
        GoldenMesh damaged = golden;
        damaged.ele_text[i] = byte;
        refused(damaged);
      }
  }
}

TEST(DamagedMeshFiles, WithDigitsPutInAnywhereTheyAreRefusedOrValid) {
  for (const GoldenMesh& golden : golden_meshes()) {
    SCOPED_TRACE(golden.name);
    for (std::size_t i = 0; i < golden.text.size(); ++i)
      for (const char* words : {"99999999", "-1 ", " nan ", " 4000000000 ", "1e300"}) {
        GoldenMesh damaged = golden;
        damaged.text.insert(i, words);
        refused(damaged);
        damaged = golden;
        damaged.text.erase(i, 7);
        refused(damaged);
      }
  }
}

#if !defined(__SANITIZE_ADDRESS__)
TEST(DamagedMeshFiles, NoneAsksForMuchMemory) {
  const std::size_t before = largest_request.exchange(0);
  for (const GoldenMesh& golden : golden_meshes())
    for (std::size_t i = 0; i < golden.text.size(); ++i)
      for (const char* words : {"9", "99999999", "4000000000", "\xff\xff\xff\x7f"}) {
        GoldenMesh damaged = golden;
        damaged.text.insert(i, words);
        refused(damaged);
        damaged.text = golden.text;
        damaged.text.replace(i, 4, words);
        refused(damaged);
      }
  EXPECT_LT(largest_request.load(), std::size_t{1} << 17);
  if (before > largest_request) largest_request = before;
}
#endif

}  // namespace
}  // namespace hmax
