/// What limits ask of structures whose damping couples the modes, by SLEPc.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "addons/petsc/petsc_calls.hpp"
#include "limits/distributed/distributed_engine.hpp"

namespace hmax::petsc {

/// The matrices of (lambda^2 M + lambda C + K) u = 0, symmetric.
struct Damped {
  Mat K, C, M;      ///< M null for I
  KSP divide_by_M;  ///< null for I
};

/// As DistributedModel::largest_of_sum, to a residual of `tolerance`, which has the unit of the eigenvalue.
/// Collective.
SumEnd largest_of_sum(const Damped& matrices, double a, double b, double tolerance);

/// As DistributedModel::largest_damped: two-level orthogonal Arnoldi iteration on a linearisation, which
/// divides by M once a step; each eigenvalue is then that of the quadratic which its vector makes.
/// Collective.
/// @throws std::runtime_error  where none converges
std::vector<std::complex<double>> largest_damped(const Damped& matrices, std::size_t most);

}  // namespace hmax::petsc
