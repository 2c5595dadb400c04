/// Limits of structures of which only the ends of the spectrum are known here.
#pragma once

#include <string>

#include <Eigen/SparseCore>

#include "catalogue/methods/method.hpp"
#include "limits/distributed/distributed_engine.hpp"
#include "limits/linearised_problem.hpp"
#include "problems/matrices/matrix_model.hpp"

namespace hmax {

/// A matrix in the form that engines take.
MatrixRows matrix_rows(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix);

/// Two oscillators whose kappa are the ends of a spectrum, with the damping and the kind of mass of the
/// structure: a limit on the curve of its modes depends on nothing else.
Problem pair_with_ends(const std::string& id, const StructureEnds& ends);

/// That pair near rest, with the curve of all modes of the structure: what predict() takes. The slow end is
/// the bound 0 where no kappa is negative. Where damping is general the modes are the largest eigenvalues,
/// and the range of all others, which asks the model: then called by all processes together, as predict() is,
/// and the model has to outlive it.
/// @param kind  of the matrices of a user, or of a body at rest
/// @throws std::exception  where an iteration does not end
Linearised linearised(const Problem& pair, DistributedModel& model, StateKind kind = StateKind::matrices);

/// What the engine is asked of these files.
/// @throws InputError  for files of other models than constant matrices of second order
DistributedStructure distributed_structure(const MatrixFiles& files, double alpha, double beta);

}  // namespace hmax
