/// Files that were cut off or damaged anywhere: every one is refused in a sentence or read as a mesh whose
/// indices and numbers can be relied on, and none makes the readers ask for memory that it does not fill.
#include <atomic>
#include <cstdlib>
#include <new>
#include <stdexcept>

#include <gtest/gtest.h>

#include "problems/tissue/mesh_defects.hpp"
#include "problems/tissue/mesh_import.hpp"
#include "tests/problems/tissue/mesh_goldens.hpp"

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

TEST(DamagedMeshFiles, CutOffAnywhereTheyAreRefusedOrWhole) {
  for (const GoldenMesh& golden : golden_meshes()) {
    SCOPED_TRACE(golden.name);
    std::size_t refusals = 0;
    for (std::size_t size = 0; size < golden.text.size(); ++size) {
      GoldenMesh cut = golden;
      cut.text.resize(size);
      refusals += refused(cut);
    }
    for (std::size_t size = 0; size < golden.ele_text.size(); ++size) {
      GoldenMesh cut = golden;
      cut.ele_text.resize(size);
      refusals += refused(cut);
    }
    // All but cuts within the last words.
    EXPECT_GT(refusals, (golden.text.size() + golden.ele_text.size()) / 2);
  }
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
