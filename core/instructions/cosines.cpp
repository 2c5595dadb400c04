#include "core/instructions/cosines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/instructions/compiled_for.hpp"
#include "core/instructions/cosine.hpp"

namespace hmax {

namespace {

using namespace cosine_parts;

/// Numbers that go through vector registers together: two of the widest kind.
constexpr std::size_t block = 16;

/// out = cos(x) where is_plain(); whether that is everywhere.
[[gnu::always_inline]] inline bool plain_cosines(const double* __restrict x, double* __restrict out) {
  std::uint64_t others = 0;
  for (std::size_t i = 0; i < block; ++i) {
    const double size = std::abs(x[i]);
    const Reduced at = reduced(size);
    out[i] = cosine_at(at);
    others |= is_plain(size, at.y) ? 0 : 1;
  }
  return others == 0;
}

/// Where the plain formulas are not enough: rare, and out of the way of the loops.
[[gnu::noinline]] double other_cosine(double size) {
  return size < far_angle ? cosine_at(reduced_with_care(size)) : std::cos(size);
}

/// The cosines of a block.
[[gnu::always_inline]] inline void block_of_cosines(const double* __restrict x, double* __restrict out) {
  if (!plain_cosines(x, out))
    for (std::size_t i = 0; i < block; ++i)
      if (const double size = std::abs(x[i]); !is_plain(size, reduced(size).y)) out[i] = other_cosine(size);
}

/// One block after the other; the last one is filled up.
[[gnu::always_inline]] inline void cosines_in_blocks(std::span<const double> x, std::span<double> out) {
  const std::size_t rest = x.size() % block, whole = x.size() - rest;
  for (std::size_t first = 0; first < whole; first += block)
    block_of_cosines(x.data() + first, out.data() + first);
  if (rest == 0) return;
  std::array<double, block> last, found;
  last.fill(1);
  std::copy_n(x.data() + whole, rest, last.data());
  block_of_cosines(last.data(), found.data());
  std::copy_n(found.data(), rest, out.data() + whole);
}

}  // namespace

bool cosines_are_those_of_musl() { return HMAX_HAVE_MUSL; }

void cosines(std::span<const double> x, std::span<double> out, InstructionSet set) {
  if (HMAX_HAVE_MUSL)
    CompiledFor<cosines_in_blocks>::of(set)(x, out);
  else
    std::ranges::transform(x, out.begin(), [](double each) { return std::cos(each); });
}

}  // namespace hmax
