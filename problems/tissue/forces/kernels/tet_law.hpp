/// The laws of tetrahedra that the kernels have.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hmax {

/// GreenStrain, SmallStrain, StableNeoHookean and Corotational of elasticity.hpp.
enum class TetLaw : std::uint8_t { green, small_strain, neo_hookean, corotational };
inline constexpr std::size_t tet_laws = 4;

}  // namespace hmax
