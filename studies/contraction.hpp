/// Whether a step brings two solutions of a dissipative equation nearer, as the equation does: B-stability.
#pragma once

#include <string>
#include <vector>

#include "results/json.hpp"

namespace hmax {

/// One method on two equations whose solutions come nearer: y' = -y^3, and y' = -atan(y), steep at 0 alone.
struct Contraction {
  std::string method;
  double cubic = 0,     ///< largest distance after a step over that before it, on y' = -y^3
      arctan = 0;       ///< and on y' = -atan(y)
  bool nearer = false;  ///< no step of both brings two solutions apart
  int unsolved = 0;     ///< steps whose equations were not solved, which do not count
};
HMAX_RECORD(Contraction, method, cubic, arctan, nearer, unsolved);

/// Of pairs of starts up to 2 and steps of 0.1 to 100.
std::vector<Contraction> contractions(const std::vector<std::string>& methods);

}  // namespace hmax
