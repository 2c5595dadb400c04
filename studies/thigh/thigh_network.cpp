#include "studies/thigh/thigh_network.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <fmt/format.h>

namespace hmax {

namespace {

using Array = Eigen::ArrayXXd;

constexpr double depth_unit = 0.02, force_unit = 10, least_force = 1;  // [m], [N], [N]

Eigen::ArrayXXd tanh_of(const Eigen::MatrixXd& x) {
  return x.unaryExpr([](double value) { return std::tanh(value); }).array();
}

/// The measurements as matrices with one column for each.
struct Batch {
  Eigen::SparseMatrix<double> input;    // penetrations over depth_unit, shape (points, values)
  Eigen::SparseMatrix<double> pressed;  // 1 for points that the probe presses, same shape
  Eigen::VectorXd force;                // measured [N]

  Batch(const Thigh& layout, std::span<const ForceSeries> data)
      : input(layout.points(), value_count(data)), pressed(input), force(forces_of(data)) {
    std::vector<Eigen::Triplet<double, Eigen::Index>> depths, ones;
    Eigen::Index k = 0;
    for (const ForceSeries& series : data) {
      const auto points = pressed_points(layout, series.point, series.probe);
      for (const double depth : series.depth) {
        for (const Eigen::Index p : points) {
          depths.emplace_back(p, k, depth / depth_unit);
          ones.emplace_back(p, k, 1);
        }
        ++k;
      }
    }
    input.setFromTriplets(depths.begin(), depths.end());
    pressed.setFromTriplets(ones.begin(), ones.end());
  }

  [[nodiscard]] Eigen::VectorXd forces(const ThighNetwork& network, Array& hidden, Array& weights) const {
    Eigen::MatrixXd x = network.W * input;
    x.colwise() += network.c;
    hidden = tanh_of(x);
    weights = (network.V.transpose() * pressed).eval().array();
    const Eigen::ArrayXd rest = tanh_of(network.c);
    return force_unit * (weights * (hidden.colwise() - rest)).colwise().sum().matrix().transpose();
  }

  double error(const ThighNetwork& network, Eigen::VectorXd* gradient) const {
    Array hidden, weights;
    const Eigen::VectorXd residual =
        (forces(network, hidden, weights) - force).array() / (force.array() + least_force);
    const auto count = static_cast<double>(force.size());
    if (gradient) {
      const Eigen::ArrayXd rest = tanh_of(network.c);
      // d error / d force of each measurement.
      const Eigen::ArrayXd slope = 2 * force_unit / count * residual.array() / (force.array() + least_force);
      const Array back = (weights * (1 - hidden.square())).rowwise() * slope.transpose();
      const Eigen::MatrixXd W = back.matrix() * input.transpose();
      const Eigen::ArrayXd at_rest = (weights.rowwise() * slope.transpose()).rowwise().sum();
      const Eigen::VectorXd c = back.rowwise().sum() - at_rest * (1 - rest.square());
      const Array moved = (hidden.colwise() - rest).rowwise() * slope.transpose();
      const Eigen::MatrixXd V = pressed * moved.matrix().transpose();
      gradient->resize(W.size() + c.size() + V.size());
      *gradient << W.reshaped(), c, V.reshaped();
    }
    return residual.squaredNorm() / count;
  }
};

ThighNetwork started(Eigen::Index points, const Training& training) {
  std::mt19937_64 random(training.seed);
  const auto even = [&](double) { return 2 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1; };
  const Eigen::Index hidden = training.hidden;
  return {
      .W = Eigen::MatrixXd::Zero(hidden, points).unaryExpr(even),
      .c = Eigen::VectorXd::Zero(hidden).unaryExpr(even),
      .V = Eigen::MatrixXd::Zero(points, hidden).unaryExpr(even) / std::sqrt(static_cast<double>(hidden))};
}

/// Adds a step in the order of the gradient.
void add(ThighNetwork& network, const Eigen::ArrayXd& step) {
  const Eigen::Index w = network.W.size(), c = network.c.size(), v = network.V.size();
  network.W.reshaped().array() += step.head(w);
  network.c.array() += step.segment(w, c);
  network.V.reshaped().array() += step.tail(v);
}

}  // namespace

Eigen::VectorXd ThighNetwork::forces(const Eigen::VectorXd& penetration) const {
  const Eigen::ArrayXXd moved = tanh_of(W * (penetration / depth_unit) + c) - tanh_of(c);
  return force_unit * (V * moved.matrix());
}

double training_error(const ThighNetwork& network, const Thigh& layout, std::span<const ForceSeries> data,
                      Eigen::VectorXd* gradient) {
  return Batch(layout, data).error(network, gradient);
}

Eigen::VectorXd forces_of(const ThighNetwork& network, const Thigh& layout,
                          std::span<const ForceSeries> data) {
  Array hidden, weights;
  return Batch(layout, data).forces(network, hidden, weights);
}

ThighNetwork train(const Thigh& layout, std::span<const ForceSeries> data, const Training& training) {
  if (training.hidden < 1 || training.epochs < 1 || value_count(data) < 1)
    throw std::invalid_argument(fmt::format(
        "a network of {} hidden units cannot be trained in {} epochs on {} forces; give at least one of each",
        training.hidden, training.epochs, value_count(data)));
  const Batch batch(layout, data);
  ThighNetwork network = started(layout.points(), training);
  constexpr double keep = 0.9, keep_square = 0.999, small = 1e-8;
  Eigen::VectorXd gradient;
  batch.error(network, &gradient);
  Eigen::ArrayXd mean = Eigen::ArrayXd::Zero(gradient.size()), square = mean;
  double share = 1, share_square = 1;  // of the start that is left in both means
  for (int epoch = 0; epoch < training.epochs; ++epoch) {
    batch.error(network, &gradient);
    share *= keep;
    share_square *= keep_square;
    mean = keep * mean + (1 - keep) * gradient.array();
    square = keep_square * square + (1 - keep_square) * gradient.array().square();
    const double done = static_cast<double>(epoch) / training.epochs;
    const double rate = training.rate * (0.01 + 0.99 * 0.5 * (1 + std::cos(std::numbers::pi * done)));
    add(network, -rate / (1 - share) * mean / ((square / (1 - share_square)).sqrt() + small));
  }
  return network;
}

}  // namespace hmax
