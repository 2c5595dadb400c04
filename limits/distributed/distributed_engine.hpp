/// Matrices that lie in pieces on many processes, behind an interface that knows no library.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/structure_operator.hpp"

namespace hmax {

/// A matrix by rows: columns and values of row i lie in [first[i], first[i + 1]). All counts from 0.
struct MatrixRows {
  std::int64_t rows = 0, columns = 0;
  std::vector<std::int64_t> first{};  ///< shape (rows + 1)
  std::vector<int> column{};          ///< shape (entries), rising within a row
  std::vector<double> value{};        ///< shape (entries)
};

/// A structure whose rows each process makes by itself, some at a time. K has no negative eigenvalue.
struct StructurePieces {
  /// Of some rows; columns count over all of them. C without rows where there is none.
  struct Rows {
    MatrixRows stiffness, damping;
    std::vector<double> mass;  ///< shape (rows) [kg]
  };
  /// Entries of K in each of some rows: in the columns of the same unknowns, and in others.
  struct Lengths {
    std::vector<int> inside, outside;
  };
  std::int64_t unknowns = 0;
  int together = 1;  ///< ranges begin and end at multiples of that, as the three displacements of a point do
  bool has_damping = false;  ///< beside alpha M + beta K
  /// Of rows begin to end, of which there is one at least.
  /// @throws std::exception  one sentence
  std::function<Rows(std::int64_t begin, std::int64_t end)> rows{};
  std::function<Lengths(std::int64_t begin, std::int64_t end)> lengths{};
};

/// M q'' + (C + alpha M + beta K) q' + K q = 0 with matrices in files, or in pieces.
struct DistributedStructure {
  std::string stiffness, mass, damping;     ///< files; damping may be empty
  std::optional<StructurePieces> pieces{};  ///< in the place of files
  bool lumped = false;                      ///< masses are the sums of the rows of M
  double alpha = 0, beta = 0;               ///< [1/s], [s]
  /// Reads a file that the library behind the engine cannot: called by rank 0 alone, which then deals out the
  /// rows. A column of masses is a diagonal matrix.
  /// @throws std::exception  one sentence
  std::function<MatrixRows(const std::string& file, bool is_mass)> read;
};

/// The ends of the spectrum of K u = kappa M u, and the damping that goes with it.
struct StructureEnds {
  std::int64_t unknowns = 0;
  std::int64_t entries = 0;     ///< of K
  bool coupled_mass = false;    ///< M is not diagonal
  bool look_exchanged = false;  ///< K has the entries of a mass, and M those of a stiffness
  double alpha = 0, beta = 0;   ///< with those of the damping matrix [1/s], [s]
  double kappa_max = 0;         ///< [1/s^2]
  double residual = 0;          ///< of kappa_max, relative
  int iterations = 0;           ///< restarts of the iteration that found it
  /// C couples the modes: it is no sum of M and K, and alpha and beta are 0, those of the options are added
  /// to it.
  bool general_damping = false;
  double gamma_max = 0;  ///< then no less than the largest eigenvalue of C u = gamma M u [1/s]
  /// Of a K that has one, a negative Rayleigh quotient near the least kappa [1/s^2].
  std::optional<double> negative;
  std::string solver;  ///< what found kappa_max
};

/// The largest eigenvalue of (a C + b K) u = theta M u, and what its vector is damped and stiffened by, u^T M
/// u = 1.
struct SumEnd {
  double value = 0, residual = 0;  ///< the latter in the norm of M^-1: an eigenvalue is as near as that
  double gamma = 0, kappa = 0;     ///< u^T C u [1/s], u^T K u [1/s^2]
  bool converged = false;
};

/// What a process is about to do in a run that all of them share; the least of what all say is what all do.
enum class Going { interrupted, ended, on };

/// A structure whose rows are dealt out in blocks: every process holds its rows of all vectors, shape (rows).
/// Where M is diagonal the unknowns are u = M^1/2 q, so that M is I and K is M^-1/2 K M^-1/2. All functions
/// but rows(), ends(), fastest_shape() and noise() are called by all processes together, with the same
/// vectors.
/// @throws std::exception  where the library behind it fails
class DistributedModel {
 public:
  DistributedModel() = default;
  DistributedModel(const DistributedModel&) = delete;
  DistributedModel& operator=(const DistributedModel&) = delete;
  virtual ~DistributedModel() = default;

  /// The same numbers on all processes.
  [[nodiscard]] virtual const StructureEnds& ends() const = 0;
  /// Of this process.
  [[nodiscard]] virtual std::size_t rows() const = 0;
  /// u of kappa_max, u^T M u = 1, and pseudo-random numbers from -1/2 to 1/2 that do not depend on the number
  /// of processes: the rows of this process.
  [[nodiscard]] virtual std::span<const double> fastest_shape() const = 0;
  [[nodiscard]] virtual std::span<const double> noise() const = 0;
  /// out = K x, M x and M^-1 K x.
  virtual void stiffness_times(const double* x, double* out) = 0;
  virtual void mass_times(const double* x, double* out) = 0;
  virtual void reduced_stiffness_times(const double* x, double* out) = 0;
  /// (a M + b K)^-1 M. Where that is singular or not positive definite its apply() throws.
  virtual std::unique_ptr<StructureOperator::Inverse> inverse_of_sum(double a, double b) = 0;
  /// Where damping is general: to `tolerance` of |a| gamma_max + |b| kappa_max.
  virtual SumEnd largest_of_sum(double a, double b, double tolerance) = 0;
  /// Where damping is general: up to `most` eigenvalues of (lambda^2 M + lambda C + K) u = 0 of largest
  /// modulus, conjugates side by side and counted as one, the largest first [1/s].
  virtual std::vector<std::complex<double>> largest_damped(std::size_t most) = 0;
  /// Each number becomes its sum over all processes, the same on all of them.
  virtual void add_up(std::span<double> numbers) = 0;
  /// The largest of the numbers of all processes; not finite where one is not.
  virtual double largest(double own) = 0;
  /// What all processes do, where this one would.
  virtual Going together(Going going) = 0;
};

/// Processes that share matrices. While it lives only rank 0 prints: the standard streams of all others go to
/// the null device.
class DistributedEngine {
 public:
  DistributedEngine() = default;
  DistributedEngine(const DistributedEngine&) = delete;
  DistributedEngine& operator=(const DistributedEngine&) = delete;
  virtual ~DistributedEngine() = default;

  [[nodiscard]] virtual int ranks() const = 0;
  /// "PETSc 3.18.5, SLEPc 3.18.2"
  [[nodiscard]] virtual std::string version() const = 0;
  /// Reads or assembles the matrices and finds the ends of their spectrum. Called by all ranks together; each
  /// reads only its rows of files that the library reads itself, and makes only its rows of pieces. The
  /// engine has to outlive the model.
  /// @throws InputError  the same one on all ranks: for files that cannot be read, matrices that are not
  /// symmetric, masses that are not positive, an iteration that does not end
  virtual std::unique_ptr<DistributedModel> read(DistributedStructure structure) = 0;
  /// Does work that all ranks do together.
  /// @throws InputError  on all ranks what one of them throws as std::exception
  virtual void together(const std::function<void()>& work) = 0;
};

/// Whether this build has the engine.
bool has_distributed_engine();

/// Opens the module with the engine; nothing of it is loaded before. Once for each process.
/// @throws InputError  where this build has none, or the module cannot be opened
std::unique_ptr<DistributedEngine> open_distributed_engine();

/// What the module offers: makes the engine.
/// @throws InputError
using MakeDistributedEngine = std::unique_ptr<DistributedEngine> (*)();
inline constexpr const char* make_engine_symbol = "hmax_make_distributed_engine";

}  // namespace hmax
