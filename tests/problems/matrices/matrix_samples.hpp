/// Small matrix files in every format, as their programs write them.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "problems/matrices/read_matrix.hpp"

namespace hmax {

/// A file with the matrix it holds.
struct MatrixSample {
  std::string name, bytes;
  Eigen::MatrixXd matrix;
};

/// Big endian.
template <class T>
void append_bytes(std::string& bytes, T value) {
  const auto bits = std::bit_cast<std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>>(value);
  for (int k = static_cast<int>(sizeof(T)) - 1; k >= 0; --k)
    bytes += static_cast<char>((bits >> (8 * k)) & 0xff);
}

/// As MatView of PETSc writes it. @tparam Index  std::int32_t or std::int64_t
template <class Index>
std::string petsc_bytes(const Eigen::MatrixXd& matrix) {
  std::string bytes;
  const auto of = [](Eigen::Index value) { return static_cast<Index>(value); };
  append_bytes(bytes, static_cast<Index>(1211216));
  append_bytes(bytes, of(matrix.rows()));
  append_bytes(bytes, of(matrix.cols()));
  append_bytes(bytes, of((matrix.array() != 0).count()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    append_bytes(bytes, of((matrix.row(i).array() != 0).count()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      if (matrix(i, j) != 0) append_bytes(bytes, of(j));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      if (matrix(i, j) != 0) append_bytes(bytes, matrix(i, j));
  return bytes;
}

inline std::vector<MatrixSample> matrix_samples() {
  const Eigen::Matrix3d chain{{3, -1, 0}, {-1, 2.5, -1.5}, {0, -1.5, 1.5}};
  const Eigen::Matrix3d general{{3, -1, 0}, {2, 2.5, -1.5}, {0, 0.25, 1e-3}};
  const Eigen::Matrix3d skew{{0, -2, 0}, {2, 0, -3}, {0, 3, 0}};
  return {
      {"general.mtx",
       "%%MatrixMarket matrix coordinate real general\n% a comment\n\n3 3 7\n1 1 3\n2 1 2\n1 2 -1\n2 2 2.5\n3 2 "
       "0.25\n2 3 -1.5\n3 3 1e-3\n",
       general},
      {"symmetric.mtx",
       "%%MatrixMarket matrix coordinate real symmetric\r\n3 3 5\r\n1 1 3\r\n2 1 -1\r\n\r\n2 2 2.5\r\n3 2 -1.5\r\n3 3 "
       "1.5\r\n",
       chain},
      {"fortran.mtx",
       "%%MatrixMarket MATRIX Coordinate Real General\n 3 3 7\n 1 1 0.3D+01\n 2 1 +2.0d0\n 1 2 -1.D0\n 2 2 2.5E+00\n 3 "
       "2 0.25\n 2 3 -0.15+001\n 3 3 1.0D-03\n",
       general},
      {"skew.mtx", "%%MatrixMarket matrix coordinate integer skew-symmetric\n3 3 2\n2 1 2\n3 2 3\n", skew},
      {"array.mtx", "%%MatrixMarket matrix array real general\n3 3\n3\n2\n0\n-1\n2.5\n0.25\n0\n-1.5\n1e-3\n",
       general},
      {"packed.mtx", "%%MatrixMarket matrix array real symmetric\n3 3\n3\n-1\n0\n2.5\n-1.5\n1.5\n", chain},
      {"job.sti", "1 1 3.0e0\n1 2 -1.0e0\n2 2 2.5\n2 3 -1.5\n3 3 1.5\n", chain},
      {"unsymmetric.sti", "1 1 3\n1 2 -1\n2 1 2\n2 2 2.5\n2 3 -1.5\n3 2 0.25\n3 3 1e-3\n", general},
      {"narrow.bin", petsc_bytes<std::int32_t>(general), general},
      {"wide.petsc", petsc_bytes<std::int64_t>(chain), chain},
  };
}

}  // namespace hmax
