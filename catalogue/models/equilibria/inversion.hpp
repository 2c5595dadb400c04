/// Elements that a motion turns inside out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// The least volume of a tetrahedron of a body.
struct Inversion {
  double t = 0;                  ///< [s]
  std::int64_t tetrahedron = 0;  ///< as tetrahedron_number()
  double volume = 0;             ///< relative to that at rest; inverted where it is not above 0
};
/// "tetrahedron 17 is inverted at t = 0.21 s", or where its volume is above 0
/// "tetrahedron 17 is left 2.1 % of its volume at t = 0.21 s".
std::string in_words(const Inversion& inversion);

/// Of one state; nothing of what is no body, and where every element keeps more than `most` of its volume.
/// @param y  shape (dim)
std::optional<Inversion> inversion_at(const Problem& problem, double t,
                                      const Eigen::Ref<const Eigen::VectorXd>& y, double most = 0);

}  // namespace hmax
