#include "catalogue/methods/measured_amplification.hpp"

#include <cmath>

namespace hmax {

namespace {

struct Spiral {
  using State = Eigen::Vector2d;
  using Jacobian = Eigen::Matrix2d;
  static constexpr bool autonomous = true;
  static constexpr bool linear_stiff_part = true;
  Eigenmode mode;

  static Eigen::Index dim() { return 2; }
  [[nodiscard]] static Jacobian matrix(Complex lambda) {
    return (Jacobian() << lambda.real(), -lambda.imag(), lambda.imag(), lambda.real()).finished();
  }
  void rhs(double /*t*/, const State& y, State& dydt) const { dydt = matrix(mode.lambda) * y; }
  void jacobian(double /*t*/, const State& /*y*/, Jacobian& J) const { J = matrix(mode.frozen); }
  [[nodiscard]] double spectral_radius(double /*t*/, const State& /*y*/) const { return mode.radius; }
  void rhs_stiff(double /*t*/, const State& y, State& dydt) const { dydt = matrix(mode.stiff) * y; }
  void rhs_nonstiff(double /*t*/, const State& y, State& dydt) const {
    dydt = matrix(mode.lambda - mode.stiff) * y;
  }
  void jacobian_stiff(double /*t*/, const State& /*y*/, Jacobian& J) const { J = matrix(mode.stiff); }
};

}  // namespace

Problem spiral(const Eigenmode& mode) {
  return {.id = "spiral",
          .parameters = {{"re", mode.lambda.real()}, {"im", mode.lambda.imag()}},
          .states = {"u", "v"},
          .y0 = Eigen::Vector2d(1, 0),
          .t_end = 1,
          .system = AnySystem(Spiral{mode})};
}

Complex measured_step(const Method& method, const Eigenmode& mode) {
  const RunRecord record = method.bind(spiral(mode)).run({.t_end = 1, .h = 1}, {});
  if (record.outcome != Outcome::reached_end) return std::numeric_limits<double>::infinity();
  return {record.y[0], record.y[1]};
}

double measured_growth(const Method& method, Complex z) {
  constexpr int steps = 1500;
  const Runner runner = method.bind(spiral(Eigenmode(z)));
  const auto size_after = [&](int count) {
    const RunRecord record = runner.run({.t_end = static_cast<double>(count), .h = 1}, {});
    return record.outcome == Outcome::reached_end ? record.y.norm() : std::numeric_limits<double>::infinity();
  };
  // What dies away fast is looked at before nothing is left of it.
  for (int count = steps;; count /= 2) {
    const double late = size_after(2 * count), early = size_after(count);
    if (!std::isfinite(late)) return std::numeric_limits<double>::infinity();
    if (late > 1e-250 || count < 20) return early > 0 ? std::pow(late / early, 1.0 / count) : 0;
  }
}

Amplification measured_amplification(const Method& method) {
  Amplification amplification;
  amplification.measured = true;
  // Asked when first needed: a catalogue runs nothing.
  const auto bare = std::make_shared<Method>(method);
  const auto radius = [bare](Complex z) {
    return bare->steps_back > 0 ? measured_growth(*bare, z) : std::abs(measured_step(*bare, Eigenmode(z)));
  };
  amplification.of_eigenmode = [radius](const Eigenmode& mode) {
    Growth growth;
    growth.scale = 1 / std::abs(mode.lambda);
    growth.farthest = 100;
    growth.radius = [radius, lambda = mode.lambda](double h) { return radius(h * lambda); };
    return growth;
  };
  return amplification;
}

}  // namespace hmax
