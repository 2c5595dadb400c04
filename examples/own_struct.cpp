/// A struct of your own, integrated: a strip of tissue that stiffens as it stretches, let go under a weight.
#include <cmath>
#include <cstdio>
#include <hmax/hmax.hpp>

/// m x'' = m g - c x' - k x exp(x / l) as a first-order system in y = (x, x').
struct TissueStrip {
  using State = Eigen::Vector2d;                // x [m], x' [m/s]
  double m = 0.1, c = 0.4, k = 40.0, l = 0.02;  // kg, N s/m, N/m, m
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double /*t*/, const State& y, State& dydt) const {
    dydt[0] = y[1];
    dydt[1] = 9.81 - (c * y[1] + k * y[0] * std::exp(y[0] / l)) / m;
  }
};

int main() {
  using namespace hmax;
  using Method = tableaux::DormandPrince54;
  const Span<double> span{0, 0.5};
  TissueStrip::State y(0, 0);
  SampleEvery samples(span, 0.1, y,
                      [](double t, const auto& at) { std::printf("%.1f s  %7.4f m\n", t, at[0]); });
  const auto end = integrate(Rk<Method, TissueStrip::State>{}, TissueStrip{}, span, y,
                             adaptive<Method>({1e-8, 1e-8}), samples);
  std::printf("%s after %d steps\n", to_string(end.outcome).data(), static_cast<int>(end.stats.steps));
}
