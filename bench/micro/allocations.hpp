/// Counting heap allocations of the whole process.
#pragma once

namespace hmax::micro {

/// Calls of malloc, calloc, realloc and aligned_alloc so far, by anybody: operator new and Eigen end there.
long allocations();

}  // namespace hmax::micro
