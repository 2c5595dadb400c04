// In C++17, as integrators/odeint/implicit_steppers.cpp is.
#define BOOST_UBLAS_NDEBUG 1
#include <cmath>
#include <utility>

#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <boost/version.hpp>
#include <gtest/gtest.h>

#include "integrators/odeint/implicit_steppers.hpp"

namespace hmax::odeint {
namespace {

namespace native = boost::numeric::odeint;
using Vector = boost::numeric::ublas::vector<double>;
using Matrix = boost::numeric::ublas::matrix<double>;

// y' = -y + sin t, y(0) = 1: y = (3 e^-t + sin t - cos t) / 2.
double exact(double t) { return (3 * std::exp(-t) + std::sin(t) - std::cos(t)) / 2; }

double error_of_odeint(int steps) {
  native::rosenbrock4<double> stepper;
  const auto f = [](const Vector& y, Vector& dydt, double t) { dydt[0] = -y[0] + std::sin(t); };
  const auto J = [](const Vector&, Matrix& matrix, double t, Vector& dfdt) {
    matrix(0, 0) = -1;
    dfdt[0] = std::cos(t);
  };
  Vector y(1);
  y[0] = 1;
  for (int n = 0; n < steps; ++n) stepper.do_step(std::make_pair(f, J), y, 1.0 * n / steps, 1.0 / steps);
  return std::abs(y[0] - exact(1));
}

double error_of_ours(int steps) {
  const SystemCalls<double> calls{
      nullptr, [](void*, double t, const double* y, double* dydt) { *dydt = -*y + std::sin(t); },
      [](void*, double, const double*, double* J) { *J = -1; },
      [](void*, double t, const double*, double* dfdt) { *dfdt = std::cos(t); }};
  Rosenbrock4<double> stepper(calls, 1, 1, 1);
  double y = 1;
  for (int n = 0; n < steps; ++n) stepper.step(&y, 1.0 * n / steps, &y, 1.0 / steps);
  return std::abs(y - exact(1));
}

TEST(OdeintRosenbrock4, OfBoostHasOrderOneWhereTheSystemDependsOnTime) {
  if (BOOST_VERSION / 100 != 1074) GTEST_SKIP() << "another Boost";
  EXPECT_NEAR(std::log2(error_of_odeint(40) / error_of_odeint(80)), 1, 0.1);
}

TEST(OdeintRosenbrock4, HasOrderFourHere) {
  EXPECT_NEAR(std::log2(error_of_ours(20) / error_of_ours(40)), 4, 0.1);
}

}  // namespace
}  // namespace hmax::odeint
