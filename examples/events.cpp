/// Two observers: a needle falls from 5 cm above the skin, the run ends where it touches it, and its height
/// is printed on the way.
#include <cstdio>
#include <hmax/hmax.hpp>

struct Needle {
  using State = Eigen::Vector2d;  // height [m], velocity [m/s]
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double /*t*/, const State& y, State& dydt) const { dydt << y[1], -9.81; }
};

int main() {
  using namespace hmax;
  using Method = tableaux::DormandPrince54;
  const Span<double> span{0, 10};
  Needle::State y(0.05, 0);
  std::vector<Event<Needle::State>> touches;
  const bool terminal = true;
  EventFinder skin([](double /*t*/, const Needle::State& at) { return at[0]; }, Crossing::falling, terminal,
                   touches);
  SampleEvery heights(span, 0.04, y,
                      [](double t, const auto& at) { std::printf("%.2f s  %.4f m\n", t, at[0]); });
  // The observer that may end the run is named first: no height is printed beyond the skin.
  const auto end = integrate(Rk<Method, Needle::State>{}, Needle{}, span, y, adaptive<Method>({1e-8, 1e-8}),
                             observe(skin, heights));
  for (const auto& touch : touches)
    std::printf("%s: the needle touches the skin at %.6f s with %.6f m/s\n", to_string(end.outcome).data(),
                touch.t, touch.y[1]);
}
