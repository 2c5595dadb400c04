/// Equations of implicit steps: a sum of mass and stiffness.
#pragma once

#include <memory>

#include "addons/petsc/petsc_calls.hpp"
#include "core/structure_operator.hpp"

namespace hmax::petsc {

/// (a M + b K)^-1 M by conjugate gradients, preconditioned by the diagonal of the sum, to 1e-14 in its norm.
/// The sum is a product with both matrices and is not stored. Its apply() is collective.
/// @param M  null for I
std::unique_ptr<StructureOperator::Inverse> inverse_of_sum(Mat K, Mat M, double a, double b);

/// Conjugate gradients for A, preconditioned by its diagonal, to 1e-14 in the norm of A and at most `most`
/// iterations.
LinearSolver gradients_for(Mat A, PetscInt most);

/// @returns iterations
/// @throws std::runtime_error  where A is not positive definite, or there are too many iterations; vectors
/// that are not finite, to which runs beyond their limit come, give such ones
int solve(KSP solver, Vec b, Vec x, const std::string& what);

}  // namespace hmax::petsc
