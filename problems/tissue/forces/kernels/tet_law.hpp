/// The laws of tetrahedra that the kernels have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace hmax {

/// GreenStrain, SmallStrain, StableNeoHookean and Corotational of elasticity.hpp.
enum class TetLaw : std::uint8_t { green, small_strain, neo_hookean, corotational };
inline constexpr std::size_t tet_laws = 4;

template <TetLaw law>
using LawConstant = std::integral_constant<TetLaw, law>;

/// Calls f(LawConstant<law>{}).
template <class F>
void with_law(TetLaw law, const F& f) {
  switch (law) {
    case TetLaw::green:
      return f(LawConstant<TetLaw::green>{});
    case TetLaw::small_strain:
      return f(LawConstant<TetLaw::small_strain>{});
    case TetLaw::neo_hookean:
      return f(LawConstant<TetLaw::neo_hookean>{});
    case TetLaw::corotational:
      return f(LawConstant<TetLaw::corotational>{});
  }
}

}  // namespace hmax
