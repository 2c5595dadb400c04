/// A function compiled for every instruction set, from one source.
#pragma once

#include "core/instructions/instruction_set.hpp"

namespace hmax {

/// `body`, compiled for each set with all that it calls: CompiledFor<body>::of(set) is the one to call.
/// Inline functions that other code shares keep the instructions that every processor has.
template <auto body>
struct CompiledFor;
template <class... Args, void (*body)(Args...)>
struct CompiledFor<body> {
  static auto of([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
    if (set == InstructionSet::avx512) return avx512;
    if (set == InstructionSet::avx2) return avx2;
#endif
    return portable;
  }

 private:
  [[gnu::flatten]] static void portable(Args... args) { body(args...); }
#ifdef __x86_64__
  [[gnu::flatten, gnu::target("avx2")]] static void avx2(Args... args) { body(args...); }
  [[gnu::flatten, gnu::target("avx512f,avx512vl")]] static void avx512(Args... args) { body(args...); }
#endif
};

}  // namespace hmax
