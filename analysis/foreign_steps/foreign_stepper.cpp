#include "analysis/foreign_steps/foreign_stepper.hpp"

#include <limits>
#include <stdexcept>

namespace hmax {
namespace {

/// q i, q j, q k: an orthonormal basis of the tangent space at q, in whatever order its parts are.
Eigen::Matrix<double, 4, 3> tangents(const Eigen::Vector4d& q) {
  Eigen::Matrix<double, 4, 3> B;
  B << -q[1], -q[2], -q[3],  //
      q[0], -q[3], q[2],     //
      q[3], q[0], -q[1],     //
      -q[2], q[1], q[0];
  return B;
}

}  // namespace

Eigen::VectorXd ForeignStepper::after(int slot, const Eigen::VectorXd& y, double h, std::int64_t count) {
  restore(slot);
  set_state(y);
  if (!step(h, count)) return Eigen::VectorXd::Constant(dim(), std::numeric_limits<double>::quiet_NaN());
  return state();
}

Eigen::VectorXd ForeignStepper::advance(int slot, double h) {
  restore(slot);
  if (!step(h, 1)) return Eigen::VectorXd::Constant(dim(), std::numeric_limits<double>::quiet_NaN());
  save(slot);
  return state();
}

StateCoordinates::StateCoordinates(Eigen::Index dim, const std::vector<Eigen::Index>& quaternions) {
  std::vector<int> part(static_cast<std::size_t>(dim), -1);
  for (const Eigen::Index first : quaternions)
    for (Eigen::Index i = 0; i < 4; ++i) {
      if (first < 0 || first + 4 > dim || part[static_cast<std::size_t>(first + i)] >= 0)
        throw std::invalid_argument("quaternions of a state overlap, or lie outside of it");
      part[static_cast<std::size_t>(first + i)] = static_cast<int>(i);
    }
  for (Eigen::Index i = 0; i < dim; ++i) {
    const int at = part[static_cast<std::size_t>(i)];
    if (at == 3) continue;
    owner_.push_back(at < 0 ? i : i - at);
    turns_.push_back(at >= 0);
  }
  size_ = static_cast<Eigen::Index>(owner_.size());
}

Eigen::VectorXd StateCoordinates::at(const Eigen::VectorXd& y, const Eigen::VectorXd& x) const {
  Eigen::VectorXd z = y;
  for (Eigen::Index k = 0; k < size_; ++k) {
    const Eigen::Index i = component(k);
    if (!turns_[static_cast<std::size_t>(k)]) {
      z[i] += x[k];
      continue;
    }
    const Eigen::Vector4d q = y.segment<4>(i).normalized();
    z.segment<4>(i) = (q + tangents(q) * x.segment<3>(k)).normalized();
    k += 2;
  }
  return z;
}

Eigen::VectorXd StateCoordinates::of(const Eigen::VectorXd& y, const Eigen::VectorXd& z) const {
  Eigen::VectorXd x(size_);
  for (Eigen::Index k = 0; k < size_; ++k) {
    const Eigen::Index i = component(k);
    if (!turns_[static_cast<std::size_t>(k)]) {
      x[k] = z[i] - y[i];
      continue;
    }
    const Eigen::Vector4d q = y.segment<4>(i).normalized(), r = z.segment<4>(i).normalized();
    const double along = q.dot(r);
    // at() adds a tangent and normalises: its inverse divides by the part along q, whatever the sign.
    x.segment<3>(k) = tangents(q).transpose() * r / along;
    k += 2;
  }
  return x;
}

Eigen::VectorXd StateCoordinates::scales(const Eigen::VectorXd& of_state) const {
  Eigen::VectorXd scale(size_);
  for (Eigen::Index k = 0; k < size_; ++k) {
    const Eigen::Index i = component(k);
    scale[k] = turns_[static_cast<std::size_t>(k)] ? of_state.segment<4>(i).maxCoeff() : of_state[i];
  }
  return scale;
}

Eigen::SparseMatrix<double> StateCoordinates::pattern(const Eigen::SparseMatrix<double>& of_state) const {
  // Every coordinate of a quaternion stands for its four numbers.
  std::vector<std::vector<Eigen::Index>> coordinates(static_cast<std::size_t>(of_state.cols()));
  for (Eigen::Index k = 0; k < size_; ++k)
    for (Eigen::Index i = 0; i < (turns_[static_cast<std::size_t>(k)] ? 4 : 1); ++i)
      coordinates[static_cast<std::size_t>(component(k) + i)].push_back(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < of_state.cols(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(of_state, j); entry; ++entry)
      for (const Eigen::Index row : coordinates[static_cast<std::size_t>(entry.row())])
        for (const Eigen::Index column : coordinates[static_cast<std::size_t>(j)])
          entries.emplace_back(row, column, 1);
  Eigen::SparseMatrix<double> found(size_, size_);
  found.setFromTriplets(entries.begin(), entries.end());
  return found;
}

}  // namespace hmax
