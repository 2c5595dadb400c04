#include "core/instructions/instruction_set.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace hmax {

namespace {

/// Those of this processor, the widest first.
/// The processor is asked at run time (CPUID), so that one program serves machines with and without AVX.
/// `avx512` asks for two subsets: F for the arithmetic, VL for registers of 256 bits with masks.
std::vector<InstructionSet> available() {
  std::vector<InstructionSet> sets;
#ifdef HMAX_X86_KERNELS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl"))
    sets.push_back(InstructionSet::avx512);
  if (__builtin_cpu_supports("avx2")) sets.push_back(InstructionSet::avx2);
#endif
  sets.push_back(InstructionSet::portable);
  return sets;
}

/// `sets` with the one that HMAX_KERNELS names at the front.
/// An empty variable counts as unset. The others keep their order.
/// @throws std::invalid_argument  naming the sets of this processor
std::vector<InstructionSet> chosen_first(std::vector<InstructionSet> sets) {
  const char* const name = std::getenv("HMAX_KERNELS");
  if (!name || !*name) return sets;
  const auto chosen =
      std::find_if(sets.begin(), sets.end(), [&](InstructionSet set) { return to_string(set) == name; });
  if (chosen == sets.end()) {
    std::string known;
    for (const InstructionSet set : sets) known.append(known.empty() ? "" : ", ").append(to_string(set));
    throw std::invalid_argument("the environment variable HMAX_KERNELS is '" + std::string(name) +
                                "'; unset it, or set it to one of " + known);
  }
  // One rotation of [begin, chosen] moves the chosen set to the front and shifts the wider ones back.
  std::rotate(sets.begin(), chosen, chosen + 1);
  return sets;
}

}  // namespace

std::string_view to_string(InstructionSet set) {
  constexpr std::array<std::string_view, 3> names{"portable", "avx2", "avx512"};
  return names.at(static_cast<std::size_t>(set));
}

std::span<const InstructionSet> instruction_sets() {
  // Initialised on the first call, by one thread only; where that throws, the next call tries again.
  static const std::vector<InstructionSet> sets = chosen_first(available());
  return sets;
}

}  // namespace hmax
