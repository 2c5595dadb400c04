/// The test equation of linear stability.
#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/test_set/common.hpp"

namespace hmax {

struct DahlquistParameters {
  double lambda = -1;  ///< [1/s]
  static constexpr ParameterNames<DahlquistParameters, 1> names{{{"lambda", &DahlquistParameters::lambda}}};
};

/// y' = lambda y, y(0) = 1: what any method does to it is its stability function. t in s, y without unit.
/// @source  [dahlquist1963special]
template <class Real>
class Dahlquist {
 public:
  using State = Eigen::Matrix<Real, 1, 1>;
  using Jacobian = Eigen::Matrix<Real, 1, 1>;
  using Parameters = DahlquistParameters;
  static constexpr std::string_view id = "dahlquist", source = "dahlquist1963special",
                                    note = "y' = lambda y, the test equation of linear stability";
  static constexpr bool autonomous = true, stiff = false;
  static constexpr double t_end = 10;

  explicit Dahlquist(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)),
        lambda_(static_cast<Real>(parameters.lambda)) {}

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  static constexpr Eigen::Index dim() { return 1; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::linear; }
  [[nodiscard]] static std::vector<std::string> states() { return {"y"}; }
  [[nodiscard]] static State y0() { return State(Real(1)); }

  void rhs(Real /*t*/, const State& y, State& dydt) const noexcept { dydt[0] = lambda_ * y[0]; }
  void jacobian(Real /*t*/, const State& /*y*/, Jacobian& J) const noexcept { J(0, 0) = lambda_; }
  [[nodiscard]] Real spectral_radius(Real /*t*/, const State& /*y*/) const noexcept {
    return std::abs(lambda_);
  }

  /// y(0) e^(lambda t).
  [[nodiscard]] State exact(Real t, const State& start) const {
    using std::exp;
    return State(start[0] * exp(lambda_ * t));
  }

 private:
  Parameters parameters_;
  Real lambda_;
};

}  // namespace hmax
