// Two numbers at a time, for every processor: GCC and Clang make of it what the target has.
#include <cmath>

#include "problems/tissue/forces/kernels/kernel_loops.hpp"

namespace hmax {
namespace {

struct Lanes {
  static constexpr std::size_t width = 2;
  using V = double __attribute__((vector_size(16)));
  using InMemory = double __attribute__((vector_size(16), may_alias));
  struct Row {
    V xy, z;
  };
  struct Rows {
    Row r[2];
  };

  static V load(const double* p) { return *reinterpret_cast<const InMemory*>(p); }
  static V splat(double s) { return V{s, s}; }
  static V root(V v) { return V{std::sqrt(v[0]), std::sqrt(v[1])}; }
  static bool any(auto mask) { return (mask[0] | mask[1]) != 0; }
  static Row at(const double* x, std::int32_t p) { return {load(x + p), load(x + p + 2)}; }
  static Rows rows(const double* x, const std::int32_t* p) { return {{at(x, p[0]), at(x, p[1])}}; }
  static Rows minus(const Rows& a, const Rows& b) {
    return {{{a.r[0].xy - b.r[0].xy, a.r[0].z - b.r[0].z}, {a.r[1].xy - b.r[1].xy, a.r[1].z - b.r[1].z}}};
  }
  static Rows plus(const Rows& a, const Rows& b) {
    return {{{a.r[0].xy + b.r[0].xy, a.r[0].z + b.r[0].z}, {a.r[1].xy + b.r[1].xy, a.r[1].z + b.r[1].z}}};
  }
  static void columns(const Rows& a, V* v) {
    v[0] = V{a.r[0].xy[0], a.r[1].xy[0]};
    v[1] = V{a.r[0].xy[1], a.r[1].xy[1]};
    v[2] = V{a.r[0].z[0], a.r[1].z[0]};
  }
  static Rows back(V x, V y, V z) { return {{{V{x[0], y[0]}, V{z[0], 0}}, {V{x[1], y[1]}, V{z[1], 0}}}}; }
  static Row row(const Rows& a, std::size_t i) { return a.r[i]; }
  static void add(double* p, const Row& v) {
    *reinterpret_cast<InMemory*>(p) += v.xy;
    *reinterpret_cast<InMemory*>(p + 2) += v.z;
  }
  static void subtract(double* p, const Row& v) {
    *reinterpret_cast<InMemory*>(p) -= v.xy;
    *reinterpret_cast<InMemory*>(p + 2) -= v.z;
  }
};

}  // namespace

extern const TissueKernels tissue_kernels_portable;
constinit const TissueKernels tissue_kernels_portable = kernel_loops::kernels_of<Lanes>("portable");

}  // namespace hmax
