/// Matrices of a user as problems of the catalogue: "matrices:stiffness=K.mtx,mass=M.mtx".
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "problems/matrices/matrix_model.hpp"

namespace hmax {

/// The id of a problem of matrices; `text` is what --matrices takes: KEY=FILE,KEY=FILE.
std::string matrices_id(std::string_view text);

/// What such an id begins with.
inline constexpr std::string_view matrices_prefix = "matrices:";

/// The files of such an id.
///   stiffness=FILE,mass=FILE[,damping=FILE]  M q'' + C q' + K q = 0; mass=lumped:FILE takes the sums of rows
///   stiffness=series:FILE                    K(t) of the files that FILE names, damping alike
///   jacobian=FILE                            y' = J y
///   initial=FILE                             the start
///   storage=triangle                         files hold one triangle of symmetric matrices
///   drop=constraints                         constraint rows are left out
/// @throws InputError  for an unknown key, one that is given twice, and files that make no model
MatrixFiles matrix_files(const std::string& id);

/// The same id with file names that are meant relative to `folder`.
std::string matrices_beside(const std::string& id, const std::string& folder);

/// The problem of such an id. Its parameters are alpha [1/s] and beta [s] of Rayleigh damping, in second
/// order. The last files that were read stay in memory, so that the same model with other parameters is made
/// at once.
/// @throws InputError  for files and parameters that are none
Problem make_matrix_problem(const std::string& id, const ProblemSettings& settings);

/// The times at which the matrices of a problem are given, rising [s]; empty where they do not change, and of
/// other problems.
std::vector<double> times_of_matrices(const Problem& problem);

/// The problem with its matrices as they are at the time t [s]; others as they are.
Problem with_frozen_matrices(const Problem& problem, double t);

/// What a user should know of the matrices of a problem: constraint rows, asymmetry, modes that grow; empty
/// for other problems.
std::vector<std::string> matrix_remarks(const Problem& problem);

/// How many modes of K move without stiffness, and how many have a negative one.
struct ModeCounts {
  Eigen::Index rigid = 0, negative = 0;
};
/// Of a symmetric K of at most most_counted_modes unknowns; nothing for others.
inline constexpr Eigen::Index most_counted_modes = 6000;
std::optional<ModeCounts> mode_counts(const MatrixModel& model);

}  // namespace hmax
