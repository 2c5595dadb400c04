/// The equations of implicit steps where the unknowns of a linear structure are dealt out to processes.
#pragma once

#include <memory>
#include <stdexcept>
#include <utility>

namespace hmax {

/// M q'' + C q' + K q = 0 of which each process has some of the unknowns, in the place of matrices: those lie
/// elsewhere. The masses are one; C and K below stand for M^-1 C and M^-1 K. All processes call a function
/// together, each with its unknowns, and what the functions return is the same on all of them.
class DistributedEquations {
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

  DistributedEquations() = default;
  DistributedEquations(const DistributedEquations&) = delete;
  DistributedEquations& operator=(const DistributedEquations&) = delete;
  virtual ~DistributedEquations() = default;

  /// @param c, k  [s], [s^2]
  [[nodiscard]] virtual std::unique_ptr<Inverse> inverse(double c, double k) const = 0;
  /// out = K x.
  virtual void stiffness_times(const double* x, double* out) const = 0;
  /// No less than the largest eigenvalues of K [1/s^2] and C [1/s].
  [[nodiscard]] virtual double largest_stiffness() const = 0;
  [[nodiscard]] virtual double largest_damping() const = 0;
  /// The sum of the numbers of all processes, and the largest of them; not finite where one is not.
  [[nodiscard]] virtual double sum(double own) const = 0;
  [[nodiscard]] virtual double largest(double own) const = 0;

  /// Those of the system that this thread runs; null where all of it is on one process. A stepper asks when a
  /// run begins.
  [[nodiscard]] static std::shared_ptr<const DistributedEquations> of_this_run() { return current(); }

  /// While it lives, runs of this thread are of a system with these equations.
  class Run {
   public:
    explicit Run(std::shared_ptr<const DistributedEquations> equations) { current() = std::move(equations); }
    ~Run() { current() = nullptr; }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;
  };

 private:
  static std::shared_ptr<const DistributedEquations>& current() {
    thread_local std::shared_ptr<const DistributedEquations> equations;
    return equations;
  }
};

/// Complex equations, which are not solved on several processes.
struct ComplexEquations : std::invalid_argument {
  ComplexEquations()
      : std::invalid_argument("its equations are complex, and those of several processes are real") {}
};

}  // namespace hmax
