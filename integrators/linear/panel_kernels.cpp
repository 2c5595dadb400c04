/// Which kernels there are, by the instruction sets that the processor has.
#include "integrators/linear/panel_kernels.hpp"

#include "core/instructions/instruction_set.hpp"

namespace hmax {

/// Each is defined in its own source, compiled for its instruction set.
extern const PanelKernels<double> panel_kernels_portable;
#ifdef HMAX_X86_KERNELS
extern const PanelKernels<double> panel_kernels_avx2, panel_kernels_avx512;
#endif

/// Asked once: the instruction sets of a processor do not change.
std::span<const PanelKernels<double>* const> available_panel_kernels() {
#ifdef HMAX_X86_KERNELS
  static const auto available =
      kernels_of_sets(panel_kernels_portable, panel_kernels_avx2, panel_kernels_avx512);
#else
  static const auto available =
      kernels_of_sets(panel_kernels_portable, panel_kernels_portable, panel_kernels_portable);
#endif
  return available;
}

}  // namespace hmax
