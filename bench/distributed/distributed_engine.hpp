/// Matrices that lie in pieces on many processes, behind an interface that knows no library.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hmax {

/// A matrix by rows: columns and values of row i lie in [first[i], first[i + 1]). All counts from 0.
struct MatrixRows {
  std::int64_t rows = 0, columns = 0;
  std::vector<std::int64_t> first;  ///< shape (rows + 1)
  std::vector<int> column;          ///< shape (entries), rising within a row
  std::vector<double> value;        ///< shape (entries)
};

/// M q'' + (C + alpha M + beta K) q' + K q = 0 with matrices in files.
struct DistributedStructure {
  std::string stiffness, mass, damping;  ///< files; damping may be empty
  bool lumped = false;                   ///< masses are the sums of the rows of M
  double alpha = 0, beta = 0;            ///< [1/s], [s]
  /// Reads a file that the library behind the engine cannot: called by rank 0 alone, which then deals out the rows.
  /// A column of masses is a diagonal matrix.
  /// @throws std::exception  one sentence
  std::function<MatrixRows(const std::string& file, bool is_mass)> read;
};

/// The ends of the spectrum of K u = kappa M u, and the damping that goes with it.
struct StructureEnds {
  std::int64_t unknowns = 0;
  std::int64_t entries = 0;   ///< of K
  bool coupled_mass = false;  ///< M is not diagonal
  double alpha = 0, beta = 0;  ///< with those of the damping matrix [1/s], [s]
  double kappa_max = 0;        ///< [1/s^2]
  double residual = 0;         ///< of kappa_max, relative
  int iterations = 0;          ///< restarts of the iteration that found it
  /// Of a K that has one, a negative Rayleigh quotient near the least kappa [1/s^2].
  std::optional<double> negative;
  std::string solver;  ///< what found kappa_max
};

/// Processes that share matrices. While it lives only rank 0 prints: the standard streams of all others go to the
/// null device.
class DistributedEngine {
 public:
  DistributedEngine() = default;
  DistributedEngine(const DistributedEngine&) = delete;
  DistributedEngine& operator=(const DistributedEngine&) = delete;
  virtual ~DistributedEngine() = default;

  [[nodiscard]] virtual int ranks() const = 0;
  /// "PETSc 3.18.5, SLEPc 3.18.2"
  [[nodiscard]] virtual std::string version() const = 0;
  /// Called by all ranks together; each reads only its rows of files that the library reads itself.
  /// @throws InputError  the same one on all ranks: for files that cannot be read, matrices that are not symmetric,
  /// masses that are not positive, damping that is not a multiple of mass and stiffness, an iteration that does not end
  virtual StructureEnds ends(const DistributedStructure& structure) = 0;
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
