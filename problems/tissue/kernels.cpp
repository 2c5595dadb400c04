#include "problems/tissue/kernels.hpp"

#include <vector>

namespace hmax {

extern const TissueKernels tissue_kernels_portable;
#ifdef HMAX_X86_KERNELS
extern const TissueKernels tissue_kernels_avx2, tissue_kernels_avx512;
#endif

std::span<const TissueKernels* const> available_tissue_kernels() {
  static const std::vector<const TissueKernels*> available = [] {
    std::vector<const TissueKernels*> all;
#ifdef HMAX_X86_KERNELS
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl"))
      all.push_back(&tissue_kernels_avx512);
    if (__builtin_cpu_supports("avx2")) all.push_back(&tissue_kernels_avx2);
#endif
    all.push_back(&tissue_kernels_portable);
    return all;
  }();
  return available;
}

}  // namespace hmax
