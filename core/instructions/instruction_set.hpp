/// The instruction set of the kernels that are compiled several times: one decision for the whole process.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace hmax {

/// Kernels exist for each of these on x86-64, elsewhere for `portable` alone.
/// An instruction set that a kernel is compiled for. The set changes times, not results: kernels fix the
/// order of their sums.
enum class InstructionSet {
  portable,  ///< what every processor of the architecture has
  avx2,
  avx512  ///< AVX-512 F and VL
};

/// "portable", "avx2", "avx512".
/// The name of a set, as HMAX_KERNELS and reports use it.
std::string_view to_string(InstructionSet set);

/// The sets that this processor has: the one in use first, then the others, the widest first. In use is the
/// set that the environment variable HMAX_KERNELS names, or else the widest. The variable is read once.
/// @throws std::invalid_argument  when HMAX_KERNELS names no set of this processor
/// @return  at least one set, the last resort being `portable`; the memory lives as long as the process
std::span<const InstructionSet> instruction_sets();

/// Of each of them, in this order, the kernels that are compiled for it.
template <class Kernels>
std::vector<const Kernels*> kernels_of_sets(const Kernels& portable, const Kernels& avx2,
                                            const Kernels& avx512) {
  std::vector<const Kernels*> all;
  for (const InstructionSet set : instruction_sets())
    all.push_back(set == InstructionSet::avx512 ? &avx512 : set == InstructionSet::avx2 ? &avx2 : &portable);
  return all;
}

}  // namespace hmax
