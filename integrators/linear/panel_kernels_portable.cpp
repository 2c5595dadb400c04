// Two numbers at a time, for every processor: GCC and Clang make of it what the target has.
#include "integrators/linear/panel_loops.hpp"

namespace hmax {
namespace {

/// Two doubles a register; tiles of 4 rows and 4 columns.
struct Lanes {
  using Scalar = double;
  static constexpr int width = 2, columns = 4, vectors = 2;
  using V = double __attribute__((vector_size(16), may_alias));
  static V load(const double* p) { return *reinterpret_cast<const V*>(p); }
  static void store(double* p, V v) { *reinterpret_cast<V*>(p) = v; }
};

}  // namespace

extern const PanelKernels<double> panel_kernels_portable;
constinit const PanelKernels<double> panel_kernels_portable = panel_loops::kernels_of<Lanes>("portable");

}  // namespace hmax
