/// Matrices as texts that other programs read.
#pragma once

#include <string>

#include <Eigen/SparseCore>

namespace hmax {

/// Matrix Market, coordinate real, symmetric where the matrix is to the last bit. Numbers read back as the
/// same doubles.
/// @param comment  what the matrix is, one line
std::string matrix_market_text(const Eigen::SparseMatrix<double>& matrix, const std::string& comment);

}  // namespace hmax
