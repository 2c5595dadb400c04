/// What one step on y' = lambda y multiplies by, from the coefficients of its method.
#pragma once

#include <complex>
#include <cstddef>

#include <Eigen/LU>

namespace hmax {

/// R = 1 + zb^T (I - zA)^-1 (1, ..., 1)^T of zA(i, j) and zb(i). [hairer1996solving, IV.3 (3.2)]
template <class A, class B>
std::complex<long double> stability_function(std::size_t stages, const A& zA, const B& zb) {
  using Matrix = Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, Eigen::Dynamic>;
  const auto s = static_cast<Eigen::Index>(stages);
  Matrix rest = Matrix::Identity(s, s);
  for (Eigen::Index i = 0; i < s; ++i)
    for (Eigen::Index j = 0; j < s; ++j)
      rest(i, j) -= zA(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  const Matrix x = rest.partialPivLu().solve(Matrix::Ones(s, 1));
  std::complex<long double> R = 1;
  for (Eigen::Index i = 0; i < s; ++i) R += zb(static_cast<std::size_t>(i)) * x(i, 0);
  return R;
}

/// Of a tableau at z = h lambda.
template <class Tableau>
std::complex<long double> stability_function(const Tableau& tableau, std::complex<long double> z) {
  return stability_function(
      tableau.stages, [&](std::size_t i, std::size_t j) { return z * tableau.a[i][j]; },
      [&](std::size_t i) { return z * tableau.b[i]; });
}

}  // namespace hmax
