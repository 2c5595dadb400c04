#include "analysis/spectrum/modal_motion.hpp"

#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "analysis/spectrum/spectrum.hpp"

namespace hmax {

// Projects load and start onto the shapes: each amplitude is a linear oscillator of mass one under a
// constant force.
ModalMotion::ModalMotion(const MechanicalPart& part, const Eigen::VectorXd& force,
                         const Eigen::VectorXd& y0) {
  MechanicalModes modes = mechanical_modes(part, true);
  shapes_ = std::move(modes.shapes);
  const Eigen::Index n = part.mass.size();
  // S^-1 = S^T M: amplitudes are S^T M q, loads S^T f.
  const Eigen::VectorXd load = shapes_.transpose() * force;
  const Eigen::VectorXd q = shapes_.transpose() * part.mass.times(Eigen::VectorXd(y0.head(n)));
  const Eigen::VectorXd v = shapes_.transpose() * part.mass.times(Eigen::VectorXd(y0.tail(n)));
  amplitudes_.reserve(modes.modes.size());
  // a_i'' + gamma_i a_i' + kappa_i a_i = s_i^T f.
  for (Eigen::Index i = 0; i < n; ++i) {
    const MechanicalMode& mode = modes.modes[static_cast<std::size_t>(i)];
    // Every linear oscillator has a closed form. Its force P cos(w t) is constant with w = 0.
    amplitudes_.push_back(
        exact_solution({.m = 1, .c = mode.gamma, .k1 = mode.kappa, .k3 = 0, .P = load[i], .w = 0},
                       {q[i], v[i]})
            .value());
  }
}

Eigen::VectorXd ModalMotion::at(double t) const {
  const Eigen::Index n = shapes_.rows();
  Eigen::MatrixX2d amplitudes(n, 2);
  for (Eigen::Index i = 0; i < n; ++i)
    amplitudes.row(i) = amplitudes_[static_cast<std::size_t>(i)](t).transpose();
  Eigen::VectorXd y(2 * n);
  y.head(n).noalias() = shapes_ * amplitudes.col(0);
  y.tail(n).noalias() = shapes_ * amplitudes.col(1);
  return y;
}

std::function<Eigen::Vector<long double, Eigen::Dynamic>(long double t)> states_of(
    std::function<ModalMotion()> make) {
  struct Once {
    std::once_flag flag;
    std::optional<ModalMotion> motion;
  };
  return [make = std::move(make),
          once = std::make_shared<Once>()](long double t) -> Eigen::Vector<long double, Eigen::Dynamic> {
    std::call_once(once->flag, [&] { once->motion.emplace(make()); });
    return once->motion->at(static_cast<double>(t)).cast<long double>();
  };
}

}  // namespace hmax
