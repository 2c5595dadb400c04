/// How sparse symmetric equations are to be solved: the choice alone. The solver: sparse_solver.hpp.
#pragma once

namespace hmax {

struct LinearSolve {
  enum class By {
    automatic,           ///< conjugate gradients until their work would have paid for a factorisation
    direct,              ///< a factorisation, whatever it costs
    conjugate_gradients  ///< always
  };
  By by = By::automatic;
  double tolerance = 1e-10;  ///< of conjugate gradients: |residual| <= tolerance |right-hand side|
  int iterations = 0;        ///< at most so many, as simulators that truncate do; 0: until it is solved

  bool operator==(const LinearSolve&) const = default;
};

}  // namespace hmax
