/// Matrices in files, and what models of them are.
#pragma once

#include <fstream>
#include <stdexcept>
#include <string>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>
#include <gtest/gtest.h>

#include "problems/matrices/matrix_model.hpp"
#include "problems/matrices/matrix_writers.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {

/// A folder of matrices.
class MatrixFolder : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_ / name) << text;
    return (scratch_ / name).string();
  }
  std::string write(const std::string& name, const Eigen::MatrixXd& matrix) const {
    return write(name, matrix_market_text(Eigen::SparseMatrix<double>(matrix.sparseView()), name));
  }
  MatrixFiles files(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M) const {
    return {.stiffness = write("K.mtx", K), .mass = write("M.mtx", M)};
  }
  static std::string refusal(const MatrixFiles& files) {
    return error_of<std::invalid_argument>([&] { (void)system_of(read_matrix_model(files), 0, 0); });
  }
  static void expect_refusal(const MatrixFiles& files, const std::string& part) {
    EXPECT_TRUE(says(refusal(files), part));
  }

  Scratch scratch_;
};

inline Eigen::MatrixXd chain(Eigen::Index n) {
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    K(i, i) = 2;
    if (i > 0) K(i, i - 1) = K(i - 1, i) = -1;
  }
  return K;
}

/// Eigenvalues of M^-1 K, rising.
inline Eigen::VectorXd stiffnesses(const AnySystem& system) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(system.dofs());
  AnySystem::DofMatrix K;
  system.stiffness(0, zero, zero, K);
  const Eigen::MatrixXd full = K.index() == 0 ? std::get<0>(K) : Eigen::MatrixXd(std::get<1>(K));
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
             full, Eigen::MatrixXd(system.mass_matrix().matrix()))
      .eigenvalues();
}

}  // namespace hmax
