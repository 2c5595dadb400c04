/// An implicit method with the Jacobian of your own struct: an organ held by a capsule far stiffer than
/// itself.
#include <cstdio>

#include "integrators/explicit/adaptive.hpp"
#include "integrators/implicit/dirk.hpp"
#include "integrators/implicit/dirk_tableaux.hpp"
#include "integrators/integrate.hpp"

/// m x'' = 0.1 - c x' - k (x + 100 x^3), y = (x, x'): the damper lets the fast mode vanish in 0.02 ms.
struct Capsule {
  using State = Eigen::Vector2d;
  using Jacobian = Eigen::Matrix2d;
  double m = 0.02, c = 1000.0, k = 300.0;  // kg, N s/m, N/m
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double /*t*/, const State& y, State& dydt) const {
    dydt[0] = y[1];
    dydt[1] = (0.1 - c * y[1] - k * (y[0] + 100 * y[0] * y[0] * y[0])) / m;
  }
  void jacobian(double /*t*/, const State& y, Jacobian& J) const {
    J << 0, 1, -k * (1 + 300 * y[0] * y[0]) / m, -c / m;
  }
};

int main() {
  using namespace hmax;
  using Method = tableaux::Sdirk4;
  Capsule::State y(0.01, 0);
  Stats counts;
  const Counted system(Capsule{}, counts);
  const auto end = integrate(Dirk<Method, Capsule::State>{}, system, Span<double>{0, 20}, y,
                             adaptive<Method, DeadbandController>({1e-6, 1e-9}));
  std::printf("%s: x = %.6f m after %d steps, %d Jacobians, %d factorisations\n",
              to_string(end.outcome).data(), y[0], static_cast<int>(end.stats.steps),
              static_cast<int>(counts.jacobian), static_cast<int>(end.stats.factorisations));
}
