/// The laws of tetrahedra that the kernels have.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hmax {

/// GreenStrain, SmallStrain and StableNeoHookean of elasticity.hpp.
enum class TetLaw : std::uint8_t { green, small_strain, neo_hookean };
inline constexpr std::size_t tet_laws = 3;

}  // namespace hmax
