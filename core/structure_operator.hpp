/// A linear structure by what it does to vectors, where its matrices are in no one place.
#pragma once

#include <memory>
#include <stdexcept>

namespace hmax {

/// q'' + C q' + K q = 0, with masses of one: C and K stand for M^-1 C and M^-1 K. Where the unknowns are
/// dealt out to processes each has some; all call a function together, each with its unknowns.
class StructureOperator {
 public:
  /// (I + c C + k K)^-1.
  class Inverse {
   public:
    Inverse() = default;
    Inverse(const Inverse&) = delete;
    Inverse& operator=(const Inverse&) = delete;
    virtual ~Inverse() = default;
    /// x = (I + c C + k K)^-1 x, x of the unknowns of this process.
    /// @returns iterations
    virtual int apply(double* x) = 0;
  };

  StructureOperator() = default;
  StructureOperator(const StructureOperator&) = delete;
  StructureOperator& operator=(const StructureOperator&) = delete;
  virtual ~StructureOperator() = default;

  /// Null where it is singular.
  /// @param c, k  [s], [s^2]
  [[nodiscard]] virtual std::unique_ptr<Inverse> inverse(double c, double k) const = 0;
  /// out = K x.
  virtual void stiffness_times(const double* x, double* out) const = 0;
  /// No less than the largest eigenvalues of K [1/s^2] and C [1/s].
  [[nodiscard]] virtual double largest_stiffness() const = 0;
  [[nodiscard]] virtual double largest_damping() const = 0;
};

/// Complex equations, which no StructureOperator solves.
struct ComplexEquations : std::invalid_argument {
  ComplexEquations()
      : std::invalid_argument(
            "its equations are no real numbers in double precision, as those of several processes are") {}
};

}  // namespace hmax
