/// What the allocator of the C library keeps and gives back. Other libraries than glibc: nothing happens.
#pragma once

#include <cstddef>

namespace hmax {

/// From now on memory that is freed stays with the process and comes in huge pages, where the system has them
/// for those who ask (Linux: /sys/kernel/mm/transparent_hugepage/enabled): vectors are made and freed all the
/// time, and each page that the system hands out costs a fault. For the start of a program. Takes 1 GiB of
/// address space, of which only what is used becomes memory, or does without where that is refused (ulimit
/// -v). allocate_block() makes the exception for large blocks.
void keep_freed_memory();

/// Gives to the system what is freed now, so that resident memory is what is in use.
void return_freed_memory();

/// Blocks from which on allocate_block() leaves the heap [bytes].
inline constexpr std::size_t least_own_pages = 32 << 20;

/// Memory at a multiple of 64. Large blocks have pages of their own, huge ones where the system has them,
/// which go back to it at once: in the heap, whose freed parts stay, they leave holes that the next block may
/// not fit into. What is free in the heap goes back before they come.
/// @throws std::bad_alloc
void* allocate_block(std::size_t bytes);
/// @param bytes  as allocated
void free_block(void* block, std::size_t bytes);

}  // namespace hmax
