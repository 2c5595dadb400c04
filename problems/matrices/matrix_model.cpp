#include "problems/matrices/matrix_model.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>
#include <stdexcept>

#include "core/symmetry.hpp"
#include "problems/digits.hpp"
#include "problems/linear_structure.hpp"
#include "problems/matrices/condensation.hpp"
#include "problems/matrices/linear_first_order.hpp"
#include "problems/matrices/multipliers.hpp"
#include "problems/matrices/read_matrix.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

[[noreturn]] void fail(const std::string& file, const std::string& text) {
  throw std::invalid_argument(file + ": " + text);
}

std::string shape_of(const MatrixFile& file) {
  return std::to_string(file.rows) + " x " + std::to_string(file.columns);
}

/// A square matrix of n rows; a format without a shape may leave the last rows empty.
void require_shape(const MatrixFile& file, Eigen::Index n, const std::string& model) {
  if (file.rows == n && file.columns == n) return;
  if (file.open_shape && file.rows <= n) return;
  fail(file.name, "the matrix has the shape " + shape_of(file) + " but must have " + std::to_string(n) +
                      " x " + std::to_string(n) + ", that of " + model + "; give matrices of one model");
}

/// One triangle is mirrored where that is asked for, and refused otherwise.
void settle_triangle(MatrixFile& file, bool mirrored) {
  if (file.storage != Storage::general) return;
  const bool one = is_one_triangle(file);
  if (one && !mirrored)
    fail(
        file.name,
        "all entries stand on one side of the diagonal, and the file does not say that the matrix is symmetric; add "
        "storage=triangle to --matrices if it is, or store both triangles");
  if (mirrored && !one &&
      std::ranges::any_of(file.entries, [](const MatrixEntry& e) { return e.row() != e.col(); }))
    fail(file.name, "storage=triangle is given, and entries stand on both sides of the diagonal; remove it");
  if (one) file.storage = Storage::symmetric;
}

Sparse diagonal_matrix(const VectorXd& values) {
  Sparse matrix(values.size(), values.size());
  std::vector<MatrixEntry> entries;
  for (Eigen::Index i = 0; i < values.size(); ++i)
    if (values[i] != 0) entries.emplace_back(static_cast<int>(i), static_cast<int>(i), values[i]);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Masses from a file: a matrix, a column of masses, or the sums of rows.
Sparse mass_from(MatrixFile& file, const MatrixModel& model, std::size_t& repeated) {
  const Eigen::Index n = model.facts.rows;
  if (file.columns == 1 && file.rows == n && n > 1) return diagonal_matrix(column_of(file, 0));
  settle_triangle(file, model.files.one_triangle);
  const Sparse M = assembled(file, n, n, &repeated);
  if (!model.files.lumped) return M;
  return diagonal_matrix(M * VectorXd::Ones(n));
}

/// @throws std::invalid_argument  that names the row of a mass that is none
void check_mass(const MatrixModel& model, const Sparse& M, const std::string& file) {
  const VectorXd diagonal = M.diagonal();
  for (Eigen::Index i = 0; i < diagonal.size(); ++i)
    if (!(diagonal[i] >= 0 && std::isfinite(diagonal[i])))
      fail(
          file,
          "the mass of " + model.name_of(i) + " is " + shortest_digits(diagonal[i]) +
              " but must be finite and not negative; " +
              (model.files.lumped
                   ? "the sums of rows are no masses of quadratic elements, so give the masses that the program "
                     "lumps itself"
                   : "check the elements and densities"));
  each_entry(M, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (i != j && value != 0 && (diagonal[i] == 0 || diagonal[j] == 0))
      fail(file, "the mass matrix is not positive: " + model.name_of(diagonal[i] == 0 ? i : j) +
                     " has no mass on the diagonal and is coupled to others; export the matrix again");
  });
  if (const auto place = first_asymmetry(M))
    fail(file, "the mass matrix is not symmetric at row " + std::to_string(place->first + 1) + ", column " +
                   std::to_string(place->second + 1) + "; export the matrix again");
}

/// Translations along the directions of nodes with 3 unknowns that make no force.
Eigen::Index free_directions(const Sparse& K) {
  const Eigen::Index n = K.rows();
  if (n % 3 != 0 || n < 9) return 0;
  Eigen::Index free = 0;
  const double size = K.nonZeros() > 0 ? K.coeffs().cwiseAbs().maxCoeff() : 0;
  for (Eigen::Index k = 0; k < 3; ++k) {
    VectorXd q = VectorXd::Zero(n);
    for (Eigen::Index i = k; i < n; i += 3) q[i] = 1;
    free += (K * q).cwiseAbs().maxCoeff() <= 1e-9 * size ? 1 : 0;
  }
  return free;
}

/// Whether no entry of K is negative, and most rows of M sum to zero, as those of a stiffness do where a
/// translation makes no force.
bool look_swapped(const Sparse& K, const Sparse& M) {
  const Eigen::Index n = K.rows();
  bool negative = false;
  each_entry(K, [&](Eigen::Index, Eigen::Index, double value) { negative = negative || value < 0; });
  if (negative) return false;
  const VectorXd ones = VectorXd::Ones(n), sums = M * ones, sizes = M.cwiseAbs() * ones;
  return 2 * ((sums.array().abs() <= 1e-9 * sizes.array()) && sizes.array() > 0).count() > n;
}

std::vector<Eigen::Index> all_rows(const Sparse& A) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(A.cols()));
  std::iota(rows.begin(), rows.end(), Eigen::Index(0));
  return rows;
}

/// Unknowns of the files that are left when `out` are taken away.
std::vector<Eigen::Index> without(Eigen::Index n, const ConstraintRows& out) {
  std::vector<char> gone(static_cast<std::size_t>(n), 0);
  for (const auto* rows : {&out.decoupled, &out.penalties})
    for (const Eigen::Index i : *rows) gone[static_cast<std::size_t>(i)] = 1;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < n; ++i)
    if (!gone[static_cast<std::size_t>(i)]) kept.push_back(i);
  return kept;
}

/// The matrices of the files, of one shape.
struct Structure {
  MatrixSeries K, C;  ///< C is empty without damping
  Sparse M;

  /// Changes every matrix.
  template <class Change>
  void each(const Change& change) {
    for (MatrixSeries* series : {&K, &C})
      for (Sparse& A : series->at) Sparse(change(A)).swap(A);
    Sparse(change(M)).swap(M);
  }
  [[nodiscard]] bool varies() const { return K.varies() || C.varies(); }
};

std::vector<char> rows_without_mass(const Sparse& M) {
  std::vector<char> massless;
  const VectorXd diagonal = M.diagonal();
  for (Eigen::Index i = 0; i < diagonal.size(); ++i) massless.push_back(diagonal[i] == 0 ? 1 : 0);
  return massless;
}

/// The unknowns of the model after a reduction that keeps some of them.
void keep(MatrixModel& model, const std::vector<Eigen::Index>& kept) {
  std::vector<Eigen::Index> rows;
  for (const Eigen::Index i : kept) rows.push_back(model.unknowns[static_cast<std::size_t>(i)]);
  model.unknowns = std::move(rows);
}

std::string name_of_row(const MatrixModel& model, Eigen::Index i) {
  return model.name_of(model.unknowns[static_cast<std::size_t>(i)]);
}

void leave_out_constraint_rows(MatrixModel& model, Structure& structure) {
  MatrixFacts& facts = model.facts;
  facts.constraints = constraint_rows(structure.K.at.front(), structure.C.at.front(), structure.M);
  facts.dropped = model.files.drop_constraints && !facts.constraints.none();
  if (!facts.dropped) return;
  const std::vector<Eigen::Index> kept = without(facts.rows, facts.constraints);
  if (kept.empty())
    throw std::invalid_argument(
        "every row is a constraint row, so drop=constraints leaves nothing; remove it");
  structure.each([&](const Sparse& A) { return block_of(A, kept, kept); });
  keep(model, kept);
}

/// @throws std::invalid_argument  unless the constraints are the same at all times
void require_lasting_constraints(const MatrixSeries& K, const std::vector<Eigen::Index>& multipliers) {
  const Sparse first = block_of(K.at.front(), multipliers, all_rows(K.at.front()));
  for (std::size_t k = 1; k < K.at.size(); ++k)
    if (!(Sparse(block_of(K.at[k], multipliers, all_rows(first)) - first).norm() <= 1e-10 * first.norm()))
      throw std::invalid_argument(
          "the constraints of the Lagrange multipliers change with time, and only ones that do "
          "not can be eliminated; give stiffnesses with the same constraints");
}

void eliminate_multipliers(MatrixModel& model, Structure& structure) {
  const std::vector<char> massless = rows_without_mass(structure.M);
  const Sparse& K = structure.K.at.front();
  const std::vector<Eigen::Index> multipliers = multiplier_rows(K, massless);
  model.facts.multipliers = static_cast<Eigen::Index>(multipliers.size());
  if (multipliers.empty()) return;
  const auto name = [&](Eigen::Index i) { return name_of_row(model, i); };
  require_lasting_constraints(structure.K, multipliers);
  for (const Sparse& C : structure.C.at)
    for (const Sparse& half : {C, Sparse(C.transpose())})
      require_proportional_damping(half, K, multipliers, name);
  const ConstrainedMotions motions = constrained_motions(K, multipliers, massless, name);
  for (const Eigen::Index i : motions.redundant)
    model.facts.redundant.push_back(model.unknowns[static_cast<std::size_t>(i)]);
  structure.each([&](const Sparse& A) { return projected(A, motions.Z); });
  keep(model, motions.kept);
}

void condense_massless(MatrixModel& model, Structure& structure) {
  const std::vector<char> massless = rows_without_mass(structure.M);
  model.facts.massless = std::ranges::count(massless, 1);
  if (model.facts.massless == 0) return;
  const auto name = [&](Eigen::Index i) { return name_of_row(model, i); };
  std::vector<Eigen::Index> kept;
  if (structure.varies()) {
    const Sparse none(structure.M.rows(), structure.M.rows());
    std::vector<Eigen::Index> out;
    for (std::size_t i = 0; i < massless.size(); ++i)
      if (massless[i]) out.push_back(static_cast<Eigen::Index>(i));
    for (const Sparse& C : structure.C.at) require_proportional_damping(C, none, out, name);
    for (Sparse& K : structure.K.at) {
      CondensedStructure rest = condensed(K, none, massless, name);
      K.swap(rest.K);
      kept = std::move(rest.kept);
    }
    for (Sparse& C : structure.C.at) block_of(C, kept, kept).swap(C);
  } else {
    CondensedStructure rest = condensed(structure.K.at.front(), structure.C.at.front(), massless, name);
    structure.K.at.front().swap(rest.K);
    structure.C.at.front().swap(rest.C);
    kept = std::move(rest.kept);
  }
  block_of(structure.M, kept, kept).swap(structure.M);
  keep(model, kept);
}

/// Takes rounding out of matrices that are symmetric but for it. False where one is not symmetric.
bool settle_symmetry(MatrixSeries& series, double noise = 0) {
  const bool symmetric =
      std::ranges::all_of(series.at, [&](const Sparse& A) { return is_symmetric(A, noise); });
  if (symmetric)
    for (Sparse& A : series.at) symmetrised(A).swap(A);
  return symmetric;
}

/// @throws std::invalid_argument  where condensation or elimination has left the range of double
void require_finite(const Structure& structure) {
  const auto check = [](const Sparse& A) {
    each_entry(A, [](Eigen::Index i, Eigen::Index j, double value) {
      if (!std::isfinite(value))
        throw std::invalid_argument("without massless unknowns and multipliers row " + std::to_string(i + 1) +
                                    ", column " + std::to_string(j + 1) + " of the matrices is " +
                                    shortest_digits(value) + "; check the sizes of the numbers");
    });
  };
  for (const MatrixSeries* series : {&structure.K, &structure.C}) std::ranges::for_each(series->at, check);
  check(structure.M);
}

/// Sets K and C to those of the time t.
void set_matrices_at(double t, MatrixModel& model) {
  model.varying->combine(t, 1, 0, 0, model.K);
  if (model.facts.damped) model.varying->combine(t, 0, 1, 0, model.C);
}

/// Puts the matrices into the model.
void settle(MatrixModel& model, Structure structure) {
  MatrixFacts& facts = model.facts;
  require_finite(structure);
  each_entry(structure.M, [&](Eigen::Index i, Eigen::Index j, double value) {
    facts.coupled_mass = facts.coupled_mass || (i != j && value != 0);
  });
  facts.symmetric_K = settle_symmetry(structure.K);
  facts.symmetric_C = settle_symmetry(structure.C, damping_noise);
  facts.free_directions = model.size() == facts.rows ? free_directions(structure.K.at.front()) : 0;
  facts.look_swapped = facts.coupled_mass && look_swapped(structure.K.at.front(), structure.M);
  facts.damped = std::ranges::any_of(structure.C.at, has_entries<Sparse>);
  if (facts.coupled_mass)
    model.M.swap(structure.M);
  else
    model.mass = structure.M.diagonal();
  if (!structure.varies()) {
    if (facts.damped) model.C.swap(structure.C.at.front());
    model.K.swap(structure.K.at.front());
    return;
  }
  if (!facts.damped) structure.C = {};
  model.varying = std::make_shared<const VaryingMatrices>(std::move(structure.K), std::move(structure.C),
                                                          facts.coupled_mass ? model.M : structure.M);
  set_matrices_at(0, model);
}

/// K, C and M of the files, and what is left of them.
void reduce(MatrixModel& model, Structure structure) {
  model.unknowns = all_rows(structure.M);
  settle_symmetry(structure.K);
  settle_symmetry(structure.C, damping_noise);
  leave_out_constraint_rows(model, structure);
  eliminate_multipliers(model, structure);
  condense_massless(model, structure);
  settle(model, std::move(structure));
}

/// What stands behind stiffness= or damping=: one file, or those of a series.
struct GivenFiles {
  std::vector<double> t;
  std::vector<MatrixFile> files;
};

GivenFiles read_given(const std::string& name, bool series) {
  GivenFiles given;
  if (!series) {
    given.t = {0};
    given.files.push_back(read_matrix(name));
    return given;
  }
  for (const SeriesEntry& entry : read_series(name)) {
    given.t.push_back(entry.t);
    given.files.push_back(read_matrix(entry.file));
  }
  return given;
}

/// The matrices of files of n rows. What was read is given up.
MatrixSeries assembled_series(GivenFiles& given, Eigen::Index n, bool one_triangle, const std::string& shape,
                              std::size_t& repeated) {
  MatrixSeries series{.t = given.t, .at = {}};
  for (MatrixFile& file : given.files) {
    require_shape(file, n, shape);
    settle_triangle(file, one_triangle);
    std::size_t again = 0;
    series.at.push_back(assembled(file, n, n, &again));
    repeated += again;
    file.entries = {};
  }
  return series;
}

void read_structure(MatrixModel& model) {
  const MatrixFiles& files = model.files;
  GivenFiles K = read_given(files.stiffness, files.stiffness_series), C;
  MatrixFile M = read_matrix(files.mass);
  if (!files.damping.empty()) C = read_given(files.damping, files.damping_series);
  const MatrixFile& first = K.files.front();
  if (first.rows != first.columns)
    fail(first.name, "the stiffness has the shape " + shape_of(first) + " but must be square; give K");
  // A format without a shape leaves out rows behind the last entry.
  Eigen::Index n = first.rows;
  std::size_t entries = M.entries.size();
  for (const std::vector<MatrixFile>* each : {&K.files, &C.files})
    for (const MatrixFile& file : *each)
      if (first.open_shape && file.rows == file.columns) n = std::max(n, file.rows);
  if (first.open_shape && M.open_shape && M.rows > n)
    fail(M.name, "the mass has rows up to " + std::to_string(M.rows) + ", and the stiffness " + first.name +
                     " up to " + std::to_string(n) + "; give matrices of one model");
  if (first.open_shape && M.rows == M.columns) n = std::max(n, M.rows);
  for (const MatrixFile& file : K.files) entries += file.entries.size();
  model.facts.rows = n;
  if (static_cast<std::size_t>(n) > entries)
    fail(first.name,
         "the matrix has " + std::to_string(n) + " rows, and K and M have only " + std::to_string(entries) +
             " entries, so some unknowns have neither stiffness nor mass; check the number of rows");
  const bool column = M.columns == 1 && M.rows == n;
  if (!column) require_shape(M, n, "the stiffness");
  std::size_t& repeated = model.facts.repeated;
  const std::string shape = files.stiffness_series ? first.name : "the stiffness";
  Structure structure{.K = assembled_series(K, n, files.one_triangle, shape, repeated), .C = {}, .M = {}};
  std::size_t again = 0;
  structure.M = mass_from(M, model, again);
  repeated += again;
  check_mass(model, structure.M, M.name);
  M.entries = {};
  if (files.damping.empty())
    structure.C = {.t = {0}, .at = {Sparse(n, n)}};
  else
    structure.C = assembled_series(C, n, files.one_triangle, shape, repeated);
  model.facts.mass = structure.M.sum();
  reduce(model, std::move(structure));
}

void read_first_order(MatrixModel& model) {
  MatrixFile J = read_matrix(model.files.jacobian);
  if (J.rows != J.columns)
    fail(J.name, "the Jacobian has the shape " + shape_of(J) + " but must be square; give J");
  // A header alone must not ask for memory; rows without an entry are constants.
  constexpr Eigen::Index most_empty = 64;
  if (J.rows > 1000 && J.rows / most_empty > static_cast<Eigen::Index>(J.entries.size()))
    fail(J.name, "the matrix has " + std::to_string(J.rows) + " rows and only " +
                     std::to_string(J.entries.size()) + " entries; check the number of rows");
  if (model.files.one_triangle) settle_triangle(J, true);
  model.facts.rows = J.rows;
  model.J = assembled(J, J.rows, J.columns, &model.facts.repeated);
  model.facts.symmetric_K = !first_asymmetry(model.J);
  for (Eigen::Index i = 0; i < J.rows; ++i) model.unknowns.push_back(i);
}

/// Pseudo-random numbers of the same kind on every machine.
VectorXd random_start(Eigen::Index n) {
  std::mt19937_64 random(1);
  VectorXd q(n);
  for (double& x : q) x = random_start_size * (2 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1);
  return q;
}

VectorXd start_of_file(const MatrixModel& model) {
  const MatrixFile file = read_matrix(model.files.initial);
  const Eigen::Index n = model.facts.rows;
  const bool whole = file.rows == n || (!model.is_first_order() && file.rows == 2 * n);
  if (!whole || file.columns > 2 || (file.columns == 2 && (file.rows != n || model.is_first_order())))
    fail(file.name, "the initial state has the shape " + shape_of(file) + " but must have " +
                        std::to_string(n) + " rows, " +
                        (model.is_first_order() ? "one for each state"
                                                : "one for each unknown of the files; "
                                                  "velocities follow in a second column or in further rows"));
  VectorXd values = column_of(file, 0);
  if (file.columns == 2) {
    values.conservativeResize(2 * n);
    values.tail(n) = column_of(file, 1);
  }
  return start_from(model, values, file.name);
}

/// Of an M that couples unknowns.
std::shared_ptr<const CoupledMass> coupled_mass(const MatrixModel& model) {
  try {
    return std::make_shared<const CoupledMass>(model.M);
  } catch (const std::invalid_argument& error) {
    fail(model.files.mass, error.what());
  }
}

/// The names that CalculiX and hmax write beside a stiffness, in a file .dof.
std::vector<std::string> names_beside(const std::string& stiffness) {
  std::filesystem::path file(stiffness);
  std::error_code error;
  if (!std::filesystem::is_regular_file(file.replace_extension(".dof"), error)) return {};
  return read_unknown_names(file);
}

}  // namespace

std::string MatrixModel::name_of(Eigen::Index row) const {
  const std::string number = "unknown " + std::to_string(row + 1);
  const auto i = static_cast<std::size_t>(row);
  return i < names.size() ? number + " (" + names[i] + ")" : number;
}

MatrixModel read_matrix_model(const MatrixFiles& files) {
  MatrixModel model{.files = files, .names = names_beside(files.stiffness)};
  if (model.is_first_order())
    read_first_order(model);
  else
    read_structure(model);
  if (model.facts.coupled_mass) model.coupled = coupled_mass(model);
  if (!files.initial.empty()) {
    model.start = start_of_file(model);
  } else {
    model.start = VectorXd::Zero(model.is_first_order() ? model.size() : 2 * model.size());
    model.start.head(model.size()) = random_start(model.size());
  }
  return model;
}

VectorXd start_from(const MatrixModel& model, const VectorXd& values, const std::string& what) {
  const Eigen::Index n = model.facts.rows, kept = model.size();
  const bool with_velocities = !model.is_first_order() && values.size() == 2 * n;
  if (values.size() != n && !with_velocities)
    throw std::invalid_argument(what + ": " + std::to_string(values.size()) +
                                " numbers are given, and the model has " + std::to_string(n) +
                                (model.is_first_order() ? " states" : " unknowns") + "; give one for each");
  VectorXd start = VectorXd::Zero(model.is_first_order() ? kept : 2 * kept);
  for (Eigen::Index i = 0; i < kept; ++i) {
    const Eigen::Index row = model.unknowns[static_cast<std::size_t>(i)];
    start[i] = values[row];
    if (with_velocities) start[kept + i] = values[n + row];
  }
  return start;
}

MatrixModel frozen(MatrixModel model, double t) {
  if (model.varying) set_matrices_at(t, model);
  model.varying = nullptr;
  return model;
}

AnySystem system_of(const MatrixModel& model, double alpha, double beta) {
  if (model.is_first_order()) return AnySystem(LinearFirstOrder{model.J});
  const MassMatrix<double> M =
      model.coupled ? MassMatrix<double>(model.coupled) : MassMatrix<double>(model.mass);
  if (model.varying) return AnySystem(VaryingStructure(model.varying, M, alpha, beta));
  const Eigen::Index n = model.size();
  Sparse C(n, n);
  if (model.facts.damped) C = model.C;
  if (beta != 0) C += Sparse(beta * model.K);
  if (alpha != 0) C += Sparse(alpha * M.matrix());
  return AnySystem(LinearStructure<Sparse>(model.K, M, std::move(C)));
}

}  // namespace hmax
