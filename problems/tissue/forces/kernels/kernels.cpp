#include "problems/tissue/forces/kernels/kernels.hpp"

#include "core/instructions/instruction_set.hpp"

namespace hmax {

extern const TissueKernels tissue_kernels_portable;
#ifdef HMAX_X86_KERNELS
extern const TissueKernels tissue_kernels_avx2, tissue_kernels_avx512;
#endif

std::span<const TissueKernels* const> available_tissue_kernels() {
#ifdef HMAX_X86_KERNELS
  static const auto available =
      kernels_of_sets(tissue_kernels_portable, tissue_kernels_avx2, tissue_kernels_avx512);
#else
  static const auto available =
      kernels_of_sets(tissue_kernels_portable, tissue_kernels_portable, tissue_kernels_portable);
#endif
  return available;
}

}  // namespace hmax
