#include "problems/tissue/forces/kernels/kernels.hpp"

#include <vector>

#include "core/instructions/instruction_set.hpp"

namespace hmax {

extern const TissueKernels tissue_kernels_portable;
#ifdef HMAX_X86_KERNELS
extern const TissueKernels tissue_kernels_avx2, tissue_kernels_avx512;
#endif

namespace {

const TissueKernels* kernels_for([[maybe_unused]] InstructionSet set) {
#ifdef HMAX_X86_KERNELS
  if (set == InstructionSet::avx512) return &tissue_kernels_avx512;
  if (set == InstructionSet::avx2) return &tissue_kernels_avx2;
#endif
  return &tissue_kernels_portable;
}

}  // namespace

std::span<const TissueKernels* const> available_tissue_kernels() {
  static const std::vector<const TissueKernels*> available = [] {
    std::vector<const TissueKernels*> all;
    for (const InstructionSet set : instruction_sets()) all.push_back(kernels_for(set));
    return all;
  }();
  return available;
}

}  // namespace hmax
