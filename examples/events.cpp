/// An event: a needle falls from 5 cm above the skin, and the run ends where it touches it.
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
  Needle::State y(0.05, 0);
  std::vector<Event<Needle::State>> touches;
  const bool terminal = true;
  EventFinder skin([](double /*t*/, const Needle::State& at) { return at[0]; }, Crossing::falling, terminal,
                   touches);
  const auto end = integrate(Rk<Method, Needle::State>{}, Needle{}, Span<double>{0, 10}, y,
                             adaptive<Method>({1e-8, 1e-8}), skin);
  for (const auto& touch : touches)
    std::printf("%s: the needle touches the skin at %.6f s with %.6f m/s\n", to_string(end.outcome).data(),
                touch.t, touch.y[1]);
}
