#include "limits/modes/structure_start.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hmax {
namespace {

using Eigen::VectorXcd;
using Eigen::VectorXd;

/// u^T M q and u^T M v of the distance (q, v) from rest.
/// @param row  M u, shape (n)
Eigen::Vector2d along(const VectorXd& row, const Eigen::Ref<const VectorXd>& y, const VectorXd& rest,
                      const StructureProducts& products) {
  const Eigen::Index n = row.size();
  Eigen::Vector2d parts(row.dot(y.head(n) - rest.head(n)), row.dot(y.tail(n) - rest.tail(n)));
  if (products.add_up) products.add_up({parts.data(), 2});
  return parts;
}

}  // namespace

double StructureProducts::summed(double own) const {
  if (add_up) add_up({&own, 1});
  return own;
}

Distance energy_from(const VectorXd& rest, const StructureProducts& products) {
  return [rest, products](const Eigen::Ref<const VectorXd>& y) {
    const Eigen::Index n = rest.size() / 2;
    const VectorXd q = y.head(n) - rest.head(n), v = y.tail(n) - rest.tail(n);
    const double twice = products.summed(q.dot(products.stiffness_times(q)) + v.dot(products.mass_times(v)));
    return std::isfinite(twice) ? std::sqrt(std::max(twice, 0.0)) : std::numeric_limits<double>::infinity();
  };
}

ModeStart energy_start(const StructureProducts& products, const VectorXd& rest, const VectorXd& q,
                       const VectorXd& v, const VectorXd& noise) {
  ModeStart start{
      .rest = rest, .displacement = VectorXd(2 * q.size()), .distance = energy_from(rest, products)};
  start.displacement << q, v;
  const double size = start.distance(rest + start.displacement);
  start.displacement.tail(q.size()) +=
      0.01 * size / std::sqrt(products.summed(noise.dot(products.mass_times(noise)))) * noise;
  start.displacement /= std::sqrt(products.summed(start.displacement.squaredNorm()));
  start.mode_alone = true;
  return start;
}

Distance amplitude_from(const VectorXd& rest, const VectorXcd& of_position, const VectorXcd& of_velocity,
                        const StructureProducts& products) {
  return [rest, of_position, of_velocity, products,
          d = VectorXd()](const Eigen::Ref<const VectorXd>& y) mutable {
    const Eigen::Index n = of_position.size();
    d = y - rest;
    std::array<double, 2> parts{of_position.real().dot(d.head(n)) + of_velocity.real().dot(d.tail(n)),
                                of_position.imag().dot(d.head(n)) + of_velocity.imag().dot(d.tail(n))};
    if (products.add_up) products.add_up(parts);
    return std::hypot(parts[0], parts[1]);
  };
}

void follow(ModeStart& start, const StructureProducts& products, const VectorXd& shape) {
  const VectorXd row = products.mass_times(shape);
  start.motion = [rest = start.rest, row, products](double h) -> MotionOf {
    return [rest, row, products, h](const Eigen::Ref<const VectorXd>& y) {
      const Eigen::Vector2d parts = along(row, y, rest, products);
      return Eigen::Vector2d(parts[0] / h, parts[1]);
    };
  };
  start.beside = [rest = start.rest, shape, row, products, distance = start.distance,
                  left = VectorXd()](const Eigen::Ref<const VectorXd>& y) mutable {
    const Eigen::Index n = row.size();
    const Eigen::Vector2d parts = along(row, y, rest, products);
    left = y;
    left.head(n) -= parts[0] * shape;
    left.tail(n) -= parts[1] * shape;
    return distance(left);
  };
}

}  // namespace hmax
