/// The programs of motions as kernels, one motion a thread.
#pragma once

#include <cstdint>

#include <cuda_runtime.h>

#include "catalogue/device/motion_program.hpp"

namespace hmax {
namespace {

// Coefficients are rounded from long double as the compiler of the processor rounds them.
static_assert(static_cast<double>(1.0L + 0x1p-53L + 0x1p-63L) == 1 + 0x1p-52);

constexpr int motions_of_a_block = 128;

__device__ inline std::int64_t number_of_thread() {
  return static_cast<std::int64_t>(blockIdx.x) * motions_of_a_block + threadIdx.x;
}

template <bool steady>
__global__ void __launch_bounds__(motions_of_a_block) adaptive_motions(const AdaptiveMotions all) {
  if (const std::int64_t n = number_of_thread(); n < all.count) advance_motion<steady>(all, n);
}

template <class Method, class Motions>
__global__ void __launch_bounds__(motions_of_a_block) fixed_motions(const Motions all) {
  if (const std::int64_t n = number_of_thread(); n < all.count) advance_motion<Method>(all, n);
}

/// Launches a kernel with a thread for each of the motions.
template <class Motions>
void launch(void (*kernel)(Motions), const Motions& all, cudaStream_t stream) {
  const auto blocks = static_cast<unsigned>((all.count + motions_of_a_block - 1) / motions_of_a_block);
  kernel<<<blocks, motions_of_a_block, 0, stream>>>(all);
}

}  // namespace
}  // namespace hmax
