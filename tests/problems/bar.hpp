/// Bars of linear elements with the consistent masses that finite elements make.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/SparseCore>

namespace hmax {

/// A free bar of n elements of length 1.
/// @param stiffness, density  E A and rho A of element e
/// @return  K and M, shape (n + 1, n + 1)
template <class Stiffness, class Density>
std::pair<Eigen::SparseMatrix<double>, Eigen::SparseMatrix<double>> bar(Eigen::Index n,
                                                                        const Stiffness& stiffness,
                                                                        const Density& density) {
  std::vector<Eigen::Triplet<double>> k, m;
  for (int e = 0; e < static_cast<int>(n); ++e)
    for (const int i : {0, 1})
      for (const int j : {0, 1}) {
        k.emplace_back(e + i, e + j, (i == j ? 1.0 : -1.0) * stiffness(e));
        m.emplace_back(e + i, e + j, (i == j ? 2.0 : 1.0) / 6 * density(e));
      }
  Eigen::SparseMatrix<double> K(n + 1, n + 1), M(n + 1, n + 1);
  K.setFromTriplets(k.begin(), k.end());
  M.setFromTriplets(m.begin(), m.end());
  return {K, M};
}

/// E A = 1, rho A = 1.
inline std::pair<Eigen::SparseMatrix<double>, Eigen::SparseMatrix<double>> uniform_bar(Eigen::Index n) {
  return bar(
      n, [](int) { return 1.0; }, [](int) { return 1.0; });
}

}  // namespace hmax
