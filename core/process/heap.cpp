#include "core/process/heap.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#include <climits>

#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace hmax {

namespace {

/// As the widest registers want it.
constexpr std::align_val_t alignment{64};

}  // namespace

#ifdef __GLIBC__

namespace {

bool keeps = false;

/// AddressSanitizer watches what the allocator hands out.
bool has_own_pages([[maybe_unused]] std::size_t bytes) {
#ifdef __SANITIZE_ADDRESS__
  return false;
#else
  return bytes >= least_own_pages;
#endif
}

/// Makes the heap longer and asks for huge pages in the new part.
void extend_heap() {
  constexpr std::size_t extension = 1 << 30;
  constexpr std::uintptr_t huge_page = 2 << 20;
  const auto end_of_heap = [] { return static_cast<char*>(sbrk(0)); };
  const std::uintptr_t past_page = reinterpret_cast<std::uintptr_t>(end_of_heap()) % huge_page;
  char* const begin = end_of_heap() + (huge_page - past_page) % huge_page;
  // A block that no hole has room for; volatile, lest the compiler leaves both out.
  void* const volatile block = std::malloc(extension);
  std::free(block);
  if (char* const end = end_of_heap(); end > begin)
    madvise(begin, static_cast<std::size_t>(end - begin), MADV_HUGEPAGE);
}

}  // namespace

void keep_freed_memory() {
  keeps = true;
  // No blocks outside of the heap, which go back when they are freed.
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, INT_MAX);
  extend_heap();
}

void return_freed_memory() {
  malloc_trim(0);
  if (keeps) extend_heap();
}

void* allocate_block(std::size_t bytes) {
  if (!has_own_pages(bytes)) return ::operator new(bytes, alignment);
  malloc_trim(0);
  void* const block = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (block == MAP_FAILED) throw std::bad_alloc();
  madvise(block, bytes, MADV_HUGEPAGE);
  return block;
}

void free_block(void* block, std::size_t bytes) {
  if (!has_own_pages(bytes))
    ::operator delete(block, alignment);
  else
    munmap(block, bytes);
}

#else

void keep_freed_memory() {}
void return_freed_memory() {}
void* allocate_block(std::size_t bytes) { return ::operator new(bytes, alignment); }
void free_block(void* block, std::size_t) { ::operator delete(block, alignment); }

#endif

}  // namespace hmax
