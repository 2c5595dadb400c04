/// What the allocator of the C library keeps and gives back. Other libraries than glibc: nothing happens.
#pragma once

namespace hmax {

/// From now on memory that is freed stays with the process and comes in huge pages, where the system has them
/// for those who ask (Linux: /sys/kernel/mm/transparent_hugepage/enabled): vectors are made and freed all the
/// time, and each page that the system hands out costs a fault. For the start of a program. Takes 1 GiB of
/// address space, of which only what is used becomes memory, or does without where that is refused (ulimit
/// -v).
void keep_freed_memory();

/// Gives to the system what is freed now, so that resident memory is what is in use.
void return_freed_memory();

}  // namespace hmax
