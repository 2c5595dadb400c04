/// Indices of points and elements, which are signed, as places of a std::vector.
#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace hmax {

/// @param i  not negative
inline std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

}  // namespace hmax
