/// Which kernels there are, by the instruction sets that the processor has.
#include "integrators/linear/panel_kernels.hpp"

#include <vector>

#include "core/instructions/instruction_set.hpp"

namespace hmax {

/// Each is defined in its own source, compiled for its instruction set.
extern const PanelKernels<double> panel_kernels_portable;
#ifdef HMAX_X86_KERNELS
extern const PanelKernels<double> panel_kernels_avx2, panel_kernels_avx512;
#endif

namespace {

/// Sets without kernels of their own get the portable ones.
const PanelKernels<double>* kernels_for([[maybe_unused]] InstructionSet set) {
#ifdef HMAX_X86_KERNELS
  if (set == InstructionSet::avx512) return &panel_kernels_avx512;
  if (set == InstructionSet::avx2) return &panel_kernels_avx2;
#endif
  return &panel_kernels_portable;
}

}  // namespace

/// Asked once: the instruction sets of a processor do not change.
std::span<const PanelKernels<double>* const> available_panel_kernels() {
  static const std::vector<const PanelKernels<double>*> available = [] {
    std::vector<const PanelKernels<double>*> all;
    for (const InstructionSet set : instruction_sets()) all.push_back(kernels_for(set));
    return all;
  }();
  return available;
}

}  // namespace hmax
