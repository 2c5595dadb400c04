#include "analysis/dynamics/shown_mode.hpp"

#include <cmath>
#include <utility>

namespace hmax {

void FoundMode::look(std::complex<double> rate, double like, double error) {
  const Eigenvalue seen{rate, like, error};
  if (rate.imag() > 0) {
    if (like > oscillation_.like) oscillation_ = seen;
  } else if (like > decays_[0].like) {
    decays_[1] = std::exchange(decays_[0], seen);
  } else if (like > decays_[1].like) {
    decays_[1] = seen;
  }
}

ShownMode FoundMode::shown(ShownMode mode) const {
  // Of two or three modes of one frequency a sum is found, which is like each to 0.7 or 0.58.
  constexpr double least_like = 0.5, most_error = 1e-3;
  mode.likeness = best().like;
  mode.omega_shown = mode.zeta_shown = std::numeric_limits<double>::quiet_NaN();
  if (!(best().like >= least_like && best().error <= most_error)) return mode;
  if (&best() == &oscillation_ || mode.zeta == 1) {  // a model of first order has one decay of each shape
    mode.omega_shown = std::abs(best().rate);
    mode.zeta_shown = -best().rate.real() / mode.omega_shown;
  } else if (decays_[1].like >= least_like && decays_[1].error <= most_error) {
    // Of an overdamped oscillation: omega^2 the product of both rates, 2 zeta omega their sum.
    const double a = -decays_[0].rate.real(), b = -decays_[1].rate.real();
    mode.omega_shown = std::sqrt(a * b);
    mode.zeta_shown = (a + b) / (2 * mode.omega_shown);
  }
  return mode;
}

}  // namespace hmax
