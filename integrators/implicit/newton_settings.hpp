/// How exactly implicit methods solve their equations, as users choose it.
#pragma once

namespace hmax {

/// For runs of fixed steps; runs steered by their error take a share of the tolerated error, and only the
/// limit of iterations from here.
struct NewtonSettings {
  /// Largest error that is left, relative to the largest number of the state; 0: what rounding leaves.
  double tolerance = 0;
  int iterations = 0;  ///< limit for each stage; 0: the method's own

  bool operator==(const NewtonSettings&) const = default;
};

}  // namespace hmax
