/// Backwards in time, and tolerances: from which start does a strip of tissue arrive at a state that was
/// seen?
#include <cstdio>
#include <hmax/hmax.hpp>

/// A strip of tissue that stiffens as it stretches.
struct Strip {
  using State = Eigen::Vector2d;  // x [m], x' [m/s]
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double /*t*/, const State& y, State& dydt) const {
    dydt << y[1], -400 * y[0] * (1 + 2500 * y[0] * y[0]) - 2 * y[1];
  }
};

int main() {
  using namespace hmax;
  using Method = tableaux::DormandPrince54;
  const Strip::State seen(0.004, -0.05);
  Strip::State y = seen;
  // The span ends before it begins. Each component has a tolerance in its unit: 1e-12 m, 1e-10 m/s.
  const auto back = integrate(Rk<Method, Strip::State>{}, Strip{}, Span<double>{1, 0}, y,
                              adaptive<Method>({1e-9, Eigen::Vector2d(1e-12, 1e-10)}));
  std::printf("%s: x = %.6f m, v = %.5f m/s at %g s\n", to_string(back.outcome).data(), y[0], y[1], back.t);
  // Forwards again with the default tolerances: rtol 1e-6, atol 1e-9 of the size of x and of that of v.
  integrate(Rk<Method, Strip::State>{}, Strip{}, Span<double>{0, 1}, y,
            adaptive<Method>(default_tolerances(y, {1, 1})));
  std::printf("forwards again it is off by %.0e m\n", std::abs(y[0] - seen[0]));
}
