/// A method of your own: Ralston's rule of order 3, with the midpoint rule in it for the error.
#include <cstdio>
#include <hmax/hmax.hpp>

struct Ralston32 {
  static constexpr std::string_view id = "ralston_32";
  static constexpr int order = 3, error_order = 3;
  static constexpr hmax::ButcherTableau<3> tableau{.a = {{{}, {1 / 2.0L}, {0, 3 / 4.0L}}},
                                                   .b = {2 / 9.0L, 1 / 3.0L, 4 / 9.0L},
                                                   .b_err = {2 / 9.0L, -2 / 3.0L, 4 / 9.0L},
                                                   .c = {0, 1 / 2.0L, 3 / 4.0L}};
};
static_assert(hmax::order_of(Ralston32::tableau) == Ralston32::order);

/// A mass on a spring, x'' = -100 x.
struct Spring {
  using State = Eigen::Vector2d;  // x [m], x' [m/s]
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double /*t*/, const State& y, State& dydt) const { dydt << y[1], -100 * y[0]; }
};

int main() {
  using namespace hmax;
  Spring::State y(1, 0);
  std::puts(describe(largest_stable_step(Ralston32{}, Spring{}, y)).c_str());
  const auto end = integrate(Rk<Ralston32, Spring::State>{}, Spring{}, Span<double>{0, 1}, y,
                             adaptive<Ralston32>({1e-8, 1e-8}));
  std::printf("%s: x = %.5f m after %d steps\n", to_string(end.outcome).data(), y[0],
              static_cast<int>(end.stats.steps));
}
