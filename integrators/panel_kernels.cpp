#include "integrators/panel_kernels.hpp"

#include <vector>

namespace hmax {

extern const PanelKernels<double> panel_kernels_portable;
#ifdef HMAX_X86_KERNELS
extern const PanelKernels<double> panel_kernels_avx2, panel_kernels_avx512;
#endif

std::span<const PanelKernels<double>* const> available_panel_kernels() {
  static const std::vector<const PanelKernels<double>*> available = [] {
    std::vector<const PanelKernels<double>*> all;
#ifdef HMAX_X86_KERNELS
    if (__builtin_cpu_supports("avx512f")) all.push_back(&panel_kernels_avx512);
    if (__builtin_cpu_supports("avx2")) all.push_back(&panel_kernels_avx2);
#endif
    all.push_back(&panel_kernels_portable);
    return all;
  }();
  return available;
}

}  // namespace hmax
