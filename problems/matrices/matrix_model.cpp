#include "problems/matrices/matrix_model.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <random>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "core/size_limits.hpp"
#include "problems/digits.hpp"
#include "problems/linear_structure.hpp"
#include "problems/matrices/condensation.hpp"
#include "problems/matrices/linear_first_order.hpp"
#include "problems/matrices/read_matrix.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

[[noreturn]] void fail(const std::string& file, const std::string& text) {
  throw std::invalid_argument(file + ": " + text);
}

std::string shape_of(const MatrixFile& file) {
  return std::to_string(file.rows) + " x " + std::to_string(file.columns);
}

/// A square matrix of n rows; a format without a shape may leave the last rows empty.
void require_shape(const MatrixFile& file, Index n, const std::string& model) {
  if (file.rows == n && file.columns == n) return;
  if (file.open_shape && file.rows <= n) return;
  fail(file.name, "the matrix has the shape " + shape_of(file) + " but must have " + std::to_string(n) + " x " +
                      std::to_string(n) + ", that of " + model + "; give matrices of one model");
}

/// One triangle is mirrored where that is asked for, and refused otherwise.
void settle_triangle(MatrixFile& file, bool mirrored) {
  if (file.storage != Storage::general) return;
  const bool one = is_one_triangle(file);
  if (one && !mirrored)
    fail(file.name,
         "all entries stand on one side of the diagonal, and the file does not say that the matrix is symmetric; add "
         "storage=triangle to --matrices if it is, or store both triangles");
  if (mirrored && !one && std::ranges::any_of(file.entries, [](const MatrixEntry& e) { return e.row() != e.col(); }))
    fail(file.name, "storage=triangle is given, and entries stand on both sides of the diagonal; remove it");
  if (one) file.storage = Storage::symmetric;
}

/// The first place where A and its transpose differ by more than rounding; nothing where none does.
std::optional<std::pair<Index, Index>> first_asymmetry(const Sparse& A) {
  const Sparse difference = A - Sparse(A.transpose());
  const double allowed = 1e-10 * (A.nonZeros() > 0 ? A.coeffs().cwiseAbs().maxCoeff() : 0.0);
  std::optional<std::pair<Index, Index>> found;
  each_entry(difference, [&](Index i, Index j, double value) {
    if (!found && std::abs(value) > allowed) found = {i, j};
  });
  return found;
}

Sparse diagonal_matrix(const VectorXd& values) {
  Sparse matrix(values.size(), values.size());
  std::vector<MatrixEntry> entries;
  for (Index i = 0; i < values.size(); ++i)
    if (values[i] != 0) entries.emplace_back(static_cast<int>(i), static_cast<int>(i), values[i]);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Masses from a file: a matrix, a column of masses, or the sums of rows.
Sparse mass_from(MatrixFile& file, const MatrixModel& model, std::size_t& repeated) {
  const Index n = model.facts.rows;
  if (file.columns == 1 && file.rows == n && n > 1) return diagonal_matrix(column_of(file, 0));
  settle_triangle(file, model.files.one_triangle);
  const Sparse M = assembled(file, n, n, &repeated);
  if (!model.files.lumped) return M;
  return diagonal_matrix(M * VectorXd::Ones(n));
}

/// @throws std::invalid_argument  that names the row of a mass that is none
void check_mass(const MatrixModel& model, const Sparse& M, const std::string& file) {
  const VectorXd diagonal = M.diagonal();
  for (Index i = 0; i < diagonal.size(); ++i)
    if (!(diagonal[i] >= 0 && std::isfinite(diagonal[i])))
      fail(file, "the mass of " + model.name_of(i) + " is " + shortest_digits(diagonal[i]) +
                     " but must be finite and not negative; " +
                     (model.files.lumped
                          ? "the sums of rows are no masses of quadratic elements, so give the masses that the program "
                            "lumps itself"
                          : "check the elements and densities"));
  each_entry(M, [&](Index i, Index j, double value) {
    if (i != j && value != 0 && (diagonal[i] == 0 || diagonal[j] == 0))
      fail(file, "the mass matrix is not positive: " + model.name_of(diagonal[i] == 0 ? i : j) +
                     " has no mass on the diagonal and is coupled to others; export the matrix again");
  });
  if (const auto place = first_asymmetry(M))
    fail(file, "the mass matrix is not symmetric at row " + std::to_string(place->first + 1) + ", column " +
                   std::to_string(place->second + 1) + "; export the matrix again");
}

/// Translations along the directions of nodes with 3 unknowns that make no force.
Index free_directions(const Sparse& K) {
  const Index n = K.rows();
  if (n % 3 != 0 || n < 9) return 0;
  Index free = 0;
  const double size = K.nonZeros() > 0 ? K.coeffs().cwiseAbs().maxCoeff() : 0;
  for (Index k = 0; k < 3; ++k) {
    VectorXd q = VectorXd::Zero(n);
    for (Index i = k; i < n; i += 3) q[i] = 1;
    free += (K * q).cwiseAbs().maxCoeff() <= 1e-9 * size ? 1 : 0;
  }
  return free;
}

/// Unknowns of the files that are left when `out` are taken away.
std::vector<Index> without(Index n, const ConstraintRows& out) {
  std::vector<char> gone(static_cast<std::size_t>(n), 0);
  for (const auto* rows : {&out.decoupled, &out.penalties})
    for (const Index i : *rows) gone[static_cast<std::size_t>(i)] = 1;
  std::vector<Index> kept;
  for (Index i = 0; i < n; ++i)
    if (!gone[static_cast<std::size_t>(i)]) kept.push_back(i);
  return kept;
}

/// K, C and M of the files, and what is left of them.
void reduce(MatrixModel& model, Sparse K, Sparse C, Sparse M) {
  MatrixFacts& facts = model.facts;
  facts.constraints = constraint_rows(K, C, M);
  model.unknowns = without(facts.rows, model.files.drop_constraints ? facts.constraints : ConstraintRows{});
  facts.dropped = model.files.drop_constraints && !facts.constraints.none();
  if (facts.dropped) {
    if (model.unknowns.empty())
      throw std::invalid_argument("every row is a constraint row, so drop=constraints leaves nothing; remove it");
    K = block_of(K, model.unknowns, model.unknowns);
    C = block_of(C, model.unknowns, model.unknowns);
    M = block_of(M, model.unknowns, model.unknowns);
  }
  std::vector<char> massless;
  const VectorXd diagonal = M.diagonal();
  for (Index i = 0; i < diagonal.size(); ++i) massless.push_back(diagonal[i] == 0 ? 1 : 0);
  facts.massless = std::ranges::count(massless, 1);
  if (facts.massless > 0) {
    CondensedStructure rest =
        condensed(K, C, massless, [&](Index i) { return model.name_of(model.unknowns[static_cast<std::size_t>(i)]); });
    M = block_of(M, rest.kept, rest.kept);
    K.swap(rest.K);
    C.swap(rest.C);
    for (Index& row : rest.kept) row = model.unknowns[static_cast<std::size_t>(row)];
    model.unknowns = std::move(rest.kept);
  }
  each_entry(M, [&](Index i, Index j, double value) { facts.coupled_mass = facts.coupled_mass || (i != j && value != 0); });
  facts.symmetric_K = !first_asymmetry(K);
  facts.symmetric_C = !first_asymmetry(C);
  facts.free_directions = facts.massless == 0 && !facts.dropped ? free_directions(K) : 0;
  each_entry(C, [&](Index, Index, double value) { facts.damped = facts.damped || value != 0; });
  if (facts.damped) model.C.swap(C);
  model.K.swap(K);
  if (facts.coupled_mass)
    model.M.swap(M);
  else
    model.mass = M.diagonal();
}

void read_structure(MatrixModel& model) {
  const MatrixFiles& files = model.files;
  MatrixFile K = read_matrix(files.stiffness), M = read_matrix(files.mass);
  MatrixFile C{.name = files.damping, .format = {}, .entries = {}};
  if (!files.damping.empty()) C = read_matrix(files.damping);
  if (K.rows != K.columns) fail(K.name, "the stiffness has the shape " + shape_of(K) + " but must be square; give K");
  // A format without a shape leaves out rows behind the last entry.
  Index n = K.rows;
  for (const MatrixFile* file : {&M, &C})
    if (K.open_shape && file->rows == file->columns) n = std::max(n, file->rows);
  model.facts.rows = n;
  if (static_cast<std::size_t>(n) > K.entries.size() + M.entries.size())
    fail(K.name, "the matrix has " + std::to_string(n) + " rows, and K and M have only " +
                     std::to_string(K.entries.size() + M.entries.size()) +
                     " entries, so some unknowns have neither stiffness nor mass; check the number of rows");
  if (const bool column = M.columns == 1 && M.rows == n; !column) require_shape(M, n, "the stiffness");
  settle_triangle(K, files.one_triangle);
  std::size_t repeated[3] = {0, 0, 0};
  Sparse stiffness = assembled(K, n, n, &repeated[0]);
  K.entries = {};
  const Sparse mass = mass_from(M, model, repeated[1]);
  check_mass(model, mass, M.name);
  M.entries = {};
  Sparse damping(n, n);
  if (!files.damping.empty()) {
    require_shape(C, n, "the stiffness");
    settle_triangle(C, files.one_triangle);
    damping = assembled(C, n, n, &repeated[2]);
  }
  model.facts.repeated = repeated[0] + repeated[1] + repeated[2];
  model.facts.mass = mass.sum();
  reduce(model, std::move(stiffness), std::move(damping), mass);
}

void read_first_order(MatrixModel& model) {
  MatrixFile J = read_matrix(model.files.jacobian);
  if (J.rows != J.columns) fail(J.name, "the Jacobian has the shape " + shape_of(J) + " but must be square; give J");
  // A header alone must not ask for memory; rows without an entry are constants.
  constexpr Index most_empty = 64;
  if (J.rows > 1000 && J.rows / most_empty > static_cast<Index>(J.entries.size()))
    fail(J.name, "the matrix has " + std::to_string(J.rows) + " rows and only " + std::to_string(J.entries.size()) +
                     " entries; check the number of rows");
  if (model.files.one_triangle) settle_triangle(J, true);
  model.facts.rows = J.rows;
  model.J = assembled(J, J.rows, J.columns, &model.facts.repeated);
  model.facts.symmetric_K = !first_asymmetry(model.J);
  for (Index i = 0; i < J.rows; ++i) model.unknowns.push_back(i);
}

/// Pseudo-random numbers of the same kind on every machine, up to 1e-3.
VectorXd random_start(Index n) {
  std::mt19937_64 random(1);
  VectorXd q(n);
  for (double& x : q) x = 1e-3 * (2 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1);
  return q;
}

VectorXd start_of_file(const MatrixModel& model) {
  const MatrixFile file = read_matrix(model.files.initial);
  const Index n = model.facts.rows;
  const bool whole = file.rows == n || (!model.is_first_order() && file.rows == 2 * n);
  if (!whole || file.columns > 2 || (file.columns == 2 && (file.rows != n || model.is_first_order())))
    fail(file.name, "the initial state has the shape " + shape_of(file) + " but must have " + std::to_string(n) +
                        " rows, " + (model.is_first_order() ? "one for each state" : "one for each unknown of the files; "
                                                               "velocities follow in a second column or in further rows"));
  VectorXd values = column_of(file, 0);
  if (file.columns == 2) {
    values.conservativeResize(2 * n);
    values.tail(n) = column_of(file, 1);
  }
  return start_from(model, values, file.name);
}

/// The names that CalculiX writes beside its matrices.
std::vector<std::string> names_beside(const std::string& stiffness) {
  std::filesystem::path file(stiffness);
  if (file.extension() != ".sti") return {};
  std::error_code error;
  if (!std::filesystem::is_regular_file(file.replace_extension(".dof"), error)) return {};
  return read_unknown_names(file);
}

Eigen::LLT<MatrixXd> factor_of(const Sparse& M) { return Eigen::LLT<MatrixXd>(MatrixXd(M)); }

}  // namespace

std::string MatrixModel::name_of(Index row) const {
  const std::string number = "unknown " + std::to_string(row + 1);
  const auto i = static_cast<std::size_t>(row);
  return i < names.size() ? number + " (" + names[i] + ")" : number;
}

MatrixModel read_matrix_model(const MatrixFiles& files) {
  MatrixModel model{.files = files, .facts = {}, .K = {}, .C = {}, .mass = {}, .M = {}, .J = {}, .start = {},
                    .unknowns = {}, .names = names_beside(files.stiffness)};
  if (model.is_first_order())
    read_first_order(model);
  else
    read_structure(model);
  if (!files.initial.empty()) {
    model.start = start_of_file(model);
  } else {
    model.start = VectorXd::Zero(model.is_first_order() ? model.size() : 2 * model.size());
    model.start.head(model.size()) = random_start(model.size());
  }
  return model;
}

VectorXd start_from(const MatrixModel& model, const VectorXd& values, const std::string& what) {
  const Index n = model.facts.rows, kept = model.size();
  const bool with_velocities = !model.is_first_order() && values.size() == 2 * n;
  if (values.size() != n && !with_velocities)
    throw std::invalid_argument(what + ": " + std::to_string(values.size()) + " numbers are given, and the model has " +
                                std::to_string(n) + (model.is_first_order() ? " states" : " unknowns") +
                                "; give one for each");
  VectorXd start = VectorXd::Zero(model.is_first_order() ? kept : 2 * kept);
  for (Index i = 0; i < kept; ++i) {
    const Index row = model.unknowns[static_cast<std::size_t>(i)];
    start[i] = values[row];
    if (with_velocities) start[kept + i] = values[n + row];
  }
  return start;
}

AnySystem system_of(const MatrixModel& model, double alpha, double beta) {
  if (model.is_first_order()) return AnySystem(LinearFirstOrder{model.J});
  const Index n = model.size();
  Sparse C(n, n);
  if (model.facts.damped) C = model.C;
  if (beta != 0) C += Sparse(beta * model.K);
  if (alpha != 0) C += Sparse(alpha * (model.facts.coupled_mass ? model.M : diagonal_matrix(model.mass)));
  if (model.facts.coupled_mass) {
    if (n > most_coupled_masses)
      fail(model.files.mass, "the mass matrix couples unknowns and has " + std::to_string(n) +
                                 " rows; such a matrix is taken up to " + std::to_string(most_coupled_masses) +
                                 " rows, so write mass=lumped:" + model.files.mass +
                                 ", which takes the sums of its rows");
    return linear_structure(model.K, model.M, C);
  }
  return AnySystem(LinearStructure<Sparse>(model.K, model.mass, std::move(C)));
}

VectorXd states_of(const MatrixModel& model, const VectorXd& start) {
  if (!model.facts.coupled_mass) return start;
  const Eigen::LLT<MatrixXd> factor = factor_of(model.M);
  const Index n = model.size();
  VectorXd states(2 * n);
  states << factor.matrixU() * start.head(n), factor.matrixU() * start.tail(n);
  return states;
}

}  // namespace hmax
