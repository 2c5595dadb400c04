// Compiled with AVX-512 (integrators/CMakeLists.txt), called only where the processor has it.
#ifdef __AVX512F__
#include "integrators/linear/panel_loops.hpp"

namespace hmax {
namespace {

/// Eight doubles a register; tiles of 8 rows and 8 columns: 8 of 32 registers hold sums.
struct Lanes {
  using Scalar = double;
  static constexpr int width = 8, columns = 8, vectors = 1;
  using V = double __attribute__((vector_size(64), may_alias));
  static V load(const double* p) { return *reinterpret_cast<const V*>(p); }
  static void store(double* p, V v) { *reinterpret_cast<V*>(p) = v; }
};

}  // namespace

extern const PanelKernels<double> panel_kernels_avx512;
constinit const PanelKernels<double> panel_kernels_avx512 = panel_loops::kernels_of<Lanes>("avx512");

}  // namespace hmax
#endif
