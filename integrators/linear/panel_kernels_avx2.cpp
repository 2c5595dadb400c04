// Compiled with AVX2 (integrators/CMakeLists.txt), called only where the processor has it.
#ifdef __AVX2__
#include "integrators/linear/panel_loops.hpp"

namespace hmax {
namespace {

/// Four doubles a register; tiles of 8 rows and 4 columns: 8 of 16 registers hold sums.
struct Lanes {
  using Scalar = double;
  static constexpr int width = 4, columns = 4, vectors = 2;
  using V = double __attribute__((vector_size(32), may_alias));
  static V load(const double* p) { return *reinterpret_cast<const V*>(p); }
  static void store(double* p, V v) { *reinterpret_cast<V*>(p) = v; }
};

}  // namespace

extern const PanelKernels<double> panel_kernels_avx2;
constinit const PanelKernels<double> panel_kernels_avx2 = panel_loops::kernels_of<Lanes>("avx2");

}  // namespace hmax
#endif
