#include "analysis/dynamic_relaxation.hpp"

#include <cmath>

namespace hmax {

bool relax_dynamically(const StaticModel& model, Eigen::VectorXd& q, double tolerance, int steps) {
  using Eigen::VectorXd;
  VectorXd f(q.size()), v = VectorXd::Zero(q.size()), mass, stop = q;
  StaticModel::Matrix K;
  model.force(v, f);
  const double goal = tolerance * f.norm();
  double energy = model.energy(q), kinetic = 0, heavier = 1;
  const auto halt = [&] {
    stop = q;
    v.setZero();
    kinetic = 0;
    model.stiffness(q, K);
    mass = heavier / 2 * (K.cwiseAbs() * VectorXd::Ones(q.size()));
    mass = mass.cwiseMax(1e-6 * mass.mean());
  };
  halt();
  for (int k = 1; k <= steps; ++k) {
    model.force(q, f);
    if (f.norm() <= goal) return true;
    v += f.cwiseQuotient(mass);
    const double before = kinetic;
    kinetic = v.dot(mass.cwiseProduct(v)) / 2;
    const bool is_peak = kinetic < before;
    q += (is_peak ? -0.5 : 1.0) * v;  // back to where the peak was, on average
    constexpr int look = 64;
    if (!is_peak && k % look != 0 && std::isfinite(kinetic)) continue;
    const double now = model.energy(q);
    if (!(now <= energy + 1e-12 * std::abs(energy))) {
      heavier *= 2;
      q = stop;
      halt();
    } else if (is_peak) {
      energy = now;
      halt();
    }
  }
  return false;
}

}  // namespace hmax
