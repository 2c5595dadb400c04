// Compiled with AVX2 (problems/CMakeLists.txt), called only where the processor has it.
#ifdef __AVX2__
#include <immintrin.h>

#include "problems/tissue/forces/kernels/kernel_loops.hpp"

namespace hmax {
namespace {

struct Lanes {
  static constexpr std::size_t width = 4;
  using V = __m256d;
  using Row = __m256d;
  struct Rows {
    __m256d r[4];
  };

  static V load(const double* p) { return _mm256_load_pd(p); }
  static V splat(double s) { return _mm256_set1_pd(s); }
  static V root(V v) { return _mm256_sqrt_pd(v); }
  static bool any(auto mask) { return _mm256_movemask_pd(reinterpret_cast<V>(mask)) != 0; }
  static Rows rows(const double* x, const std::int32_t* p) {
    return {{_mm256_load_pd(x + p[0]), _mm256_load_pd(x + p[1]), _mm256_load_pd(x + p[2]),
             _mm256_load_pd(x + p[3])}};
  }
  static Rows minus(const Rows& a, const Rows& b) {
    return {{a.r[0] - b.r[0], a.r[1] - b.r[1], a.r[2] - b.r[2], a.r[3] - b.r[3]}};
  }
  static Rows plus(const Rows& a, const Rows& b) {
    return {{a.r[0] + b.r[0], a.r[1] + b.r[1], a.r[2] + b.r[2], a.r[3] + b.r[3]}};
  }
  static void columns(const Rows& a, V* v) {
    const V xz = _mm256_unpacklo_pd(a.r[0], a.r[1]), y = _mm256_unpackhi_pd(a.r[0], a.r[1]);
    const V xz2 = _mm256_unpacklo_pd(a.r[2], a.r[3]), y2 = _mm256_unpackhi_pd(a.r[2], a.r[3]);
    v[0] = _mm256_permute2f128_pd(xz, xz2, 0x20);
    v[1] = _mm256_permute2f128_pd(y, y2, 0x20);
    v[2] = _mm256_permute2f128_pd(xz, xz2, 0x31);
  }
  static Rows back(V x, V y, V z) {
    const V none = _mm256_setzero_pd();
    const V even = _mm256_unpacklo_pd(x, y), odd = _mm256_unpackhi_pd(x, y);
    const V even2 = _mm256_blend_pd(z, none, 0xa), odd2 = _mm256_unpackhi_pd(z, none);
    return {{_mm256_permute2f128_pd(even, even2, 0x20), _mm256_permute2f128_pd(odd, odd2, 0x20),
             _mm256_permute2f128_pd(even, even2, 0x31), _mm256_permute2f128_pd(odd, odd2, 0x31)}};
  }
  static Row row(const Rows& a, std::size_t i) { return a.r[i]; }
  static void add(double* p, Row v) { _mm256_store_pd(p, _mm256_load_pd(p) + v); }
  static void subtract(double* p, Row v) { _mm256_store_pd(p, _mm256_load_pd(p) - v); }
};

}  // namespace

extern const TissueKernels tissue_kernels_avx2;
constinit const TissueKernels tissue_kernels_avx2 = kernel_loops::kernels_of<Lanes>("avx2");

}  // namespace hmax
#endif
