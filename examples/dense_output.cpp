/// Dense output: the state at any time between the ends of a step, which it never shortens.
#include <cmath>
#include <cstdio>
#include <hmax/hmax.hpp>

/// A mass on a spring, x'' = -x.
struct Spring {
  using State = Eigen::Vector2d;  // x [m], x' [m/s]
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double /*t*/, const State& y, State& dydt) const { dydt << y[1], -y[0]; }
};

int main() {
  using namespace hmax;
  Spring::State y(1, 0), at = y;
  int steps = 0;
  double largest_error = 0;
  // An observer is called once for each step. It may ask for any time in it.
  const auto observer = [&](auto& step) {
    ++steps;
    for (const double share : {0.25, 0.5, 0.75}) {
      const double t = step.t0() + share * step.h();
      step.at(t, at);
      largest_error = std::fmax(largest_error, std::abs(at[0] - std::cos(t)));
    }
  };
  integrate(Rk<tableaux::Dop853, Spring::State>{}, Spring{}, Span<double>{0, 10}, y, FixedStep(0.5),
            observer);
  std::printf("%d steps, error between their ends %.0e m, at the end %.0e m\n", steps, largest_error,
              std::abs(y[0] - std::cos(10)));
}
