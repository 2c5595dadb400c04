// Compiled with AVX-512 (problems/CMakeLists.txt), called only where the processor has it.
#ifdef __AVX512VL__
#include <immintrin.h>

#include "problems/tissue/forces/kernels/kernel_loops.hpp"

namespace hmax {
namespace {

struct Lanes {
  static constexpr std::size_t width = 8;
  using V = __m512d;
  using Row = __m256d;
  struct Rows {
    __m512d r[4];  // rows k and k + 4
  };

  static V load(const double* p) { return _mm512_load_pd(p); }
  static V splat(double s) { return _mm512_set1_pd(s); }
  static V root(V v) { return _mm512_sqrt_pd(v); }
  static bool any(auto mask) {
    return _mm512_test_epi64_mask(reinterpret_cast<__m512i>(mask), reinterpret_cast<__m512i>(mask)) != 0;
  }
  static __m512d two(const double* a, const double* b) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(a)), _mm256_load_pd(b), 1);
  }
  static Rows rows(const double* x, const std::int32_t* p) {
    return {
        {two(x + p[0], x + p[4]), two(x + p[1], x + p[5]), two(x + p[2], x + p[6]), two(x + p[3], x + p[7])}};
  }
  static Rows minus(const Rows& a, const Rows& b) {
    return {{a.r[0] - b.r[0], a.r[1] - b.r[1], a.r[2] - b.r[2], a.r[3] - b.r[3]}};
  }
  static Rows plus(const Rows& a, const Rows& b) {
    return {{a.r[0] + b.r[0], a.r[1] + b.r[1], a.r[2] + b.r[2], a.r[3] + b.r[3]}};
  }
  // A transposition of 4 x 4 in each half: pairs within 128 bits, then across.
  static __m512i low() { return _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13); }
  static __m512i high() { return _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15); }
  static void columns(const Rows& a, V* v) {
    const V xz = _mm512_unpacklo_pd(a.r[0], a.r[1]), y = _mm512_unpackhi_pd(a.r[0], a.r[1]);
    const V xz2 = _mm512_unpacklo_pd(a.r[2], a.r[3]), y2 = _mm512_unpackhi_pd(a.r[2], a.r[3]);
    v[0] = _mm512_permutex2var_pd(xz, low(), xz2);
    v[1] = _mm512_permutex2var_pd(y, low(), y2);
    v[2] = _mm512_permutex2var_pd(xz, high(), xz2);
  }
  static Rows back(V x, V y, V z) {
    const V even = _mm512_unpacklo_pd(x, y), odd = _mm512_unpackhi_pd(x, y);
    const auto with_z = [&](V xy, int k) {
      const __m512i from =
          _mm512_setr_epi64(k & 2, (k & 2) + 1, 8 + k, 0, 4 + (k & 2), 5 + (k & 2), 12 + k, 0);
      return _mm512_maskz_permutex2var_pd(0x77, xy, from, z);
    };
    return {{with_z(even, 0), with_z(odd, 1), with_z(even, 2), with_z(odd, 3)}};
  }
  static Row row(const Rows& a, std::size_t i) {
    return i < 4 ? _mm512_castpd512_pd256(a.r[i]) : _mm512_extractf64x4_pd(a.r[i - 4], 1);
  }
  static void add(double* p, Row v) { _mm256_store_pd(p, _mm256_load_pd(p) + v); }
  static void subtract(double* p, Row v) { _mm256_store_pd(p, _mm256_load_pd(p) - v); }
};

}  // namespace

extern const TissueKernels tissue_kernels_avx512;
constinit const TissueKernels tissue_kernels_avx512 = kernel_loops::kernels_of<Lanes>("avx512");

}  // namespace hmax
#endif
