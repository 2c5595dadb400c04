/// A static neural model beside the springs of a thigh: penetrations in, forces out, trained on the
/// measurements.
#pragma once

#include <cstdint>
#include <span>

#include "studies/thigh/thigh_identification.hpp"

namespace hmax {

/// One hidden layer of tanh between a penetration and a force for each point,
///   f(u) = 10 N * V (tanh(W u / 20 mm + c) - tanh(c)),
/// so that a thigh that nobody touches has no force. Penetrations are those of the pressed points, 0
/// elsewhere.
struct ThighNetwork {
  Eigen::MatrixXd W;  ///< shape (hidden, points)
  Eigen::VectorXd c;  ///< shape (hidden)
  Eigen::MatrixXd V;  ///< shape (points, hidden)

  /// Forces on all points, shape (points) [N].
  [[nodiscard]] Eigen::VectorXd forces(const Eigen::VectorXd& penetration) const;
};

struct Training {
  Eigen::Index hidden = 32;
  int epochs = 6000;   ///< each over all measurements
  double rate = 0.01;  ///< of Adam, falling to a hundredth as half a cosine
  std::uint64_t seed = 1;
};

/// By gradients that are propagated back and Adam [kingma2015adam]: the mean square of (F - F_measured) /
/// (F_measured + 1 N), where F is the sum over the pressed points.
/// @throws std::invalid_argument  for a network without hidden units, epochs or data
ThighNetwork train(const Thigh& layout, std::span<const ForceSeries> data, const Training& training = {});

/// The mean of the squares that it makes small, and their gradient in the order W, c, V, column by column.
double training_error(const ThighNetwork& network, const Thigh& layout, std::span<const ForceSeries> data,
                      Eigen::VectorXd* gradient = nullptr);

/// Forces of the network on the probe, shape (values) [N].
Eigen::VectorXd forces_of(const ThighNetwork& network, const Thigh& layout,
                          std::span<const ForceSeries> data);

}  // namespace hmax
