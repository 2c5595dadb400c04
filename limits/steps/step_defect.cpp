#include "limits/steps/step_defect.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "analysis/amplification/amplification.hpp"
#include "catalogue/methods/measured_amplification.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

/// Not on one line, none of them near a pole, in the left half-plane.
constexpr std::array<Complex, 6> samples{
    {{-0.3, 0}, {-0.05, 0.4}, {-0.9, 0.7}, {-1.7, 0.2}, {-0.2, 1.3}, {-2.4, 1.9}}};

/// y_1 / y_0 as the amplification says; for want of a number only its modulus, as second.
std::pair<Complex, bool> claimed_step(const Growth& growth) {
  if (!growth.polynomial) return {growth.radius(1), false};
  const std::vector<ComplexPolynomial>& p = growth.polynomial->coefficients();
  return {Complex(-evaluate(p[0], LongComplex(1)) / evaluate(p[1], LongComplex(1))), true};
}

double of_one_step(const Method& method) {
  double worst = 0;
  for (const Complex z : samples) {
    std::vector<Eigenmode> modes{Eigenmode(z)};
    if (method.needs_split) modes.emplace_back(z).stiff = Complex(0.4, 0.1) * z;
    // Others solve their equations whatever Jacobian they are told.
    if (method.linearly_implicit) modes.emplace_back(z).frozen = Complex(0.7, -0.1) * z;
    for (const Eigenmode& mode : modes) {
      const auto [claimed, whole] = claimed_step(method.amplification->of_eigenmode(mode));
      const Complex made = measured_step(method, mode);
      const double defect = whole ? std::abs(made - claimed) : std::abs(std::abs(made) - claimed.real());
      worst = std::max(worst, defect / std::max(1.0, std::abs(claimed)));
    }
  }
  return worst;
}

/// The states of a run with steps of size one.
std::vector<Eigen::VectorXd> path(const Method& method, const Problem& problem, std::size_t steps) {
  std::vector<Eigen::VectorXd> states;
  method.bind(problem).run({.t_end = static_cast<double>(steps), .h = 1},
                           [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) { states.push_back(y); });
  return states;
}

double of_recurrence(const Method& method) {
  const std::vector<ComplexPolynomial>& p = method.amplification->in_z->coefficients();
  // The first steps are those of another method.
  const auto first = static_cast<std::size_t>(method.order) + 1;
  double worst = 0;
  for (const Complex z : samples) {
    const Complex smaller = 0.2 * z;
    const auto states = path(method, spiral(Eigenmode(smaller)), first + p.size() + 1);
    if (states.size() < first + p.size()) return infinity;
    Complex defect = 0;
    double size = 0;
    for (std::size_t j = 0; j < p.size(); ++j) {
      const Complex term =
          Complex(evaluate(p[j], LongComplex(smaller))) * Complex(states[first + j][0], states[first + j][1]);
      defect += term;
      size += std::abs(term);
    }
    worst = std::max(worst, std::abs(defect) / size);
  }
  return worst;
}

/// Two bodies between walls whose dampers couple their modes; h = 1.
struct TwoBodies {
  using State = Eigen::Vector4d;
  using Dofs = Eigen::Vector2d;
  using DofMatrix = Eigen::Matrix2d;
  static constexpr bool autonomous = true;
  double stiffer, damped;

  static Eigen::Index dim() { return 4; }
  static Eigen::Index dofs() { return 2; }
  static Dofs mass() { return {1, 2}; }
  [[nodiscard]] DofMatrix K() const { return stiffer * (DofMatrix() << 3, -1, -1, 2).finished(); }
  [[nodiscard]] DofMatrix C() const { return damped * (DofMatrix() << 0.7, 0.4, 0.4, 1.1).finished(); }
  void rhs(double /*t*/, const State& y, State& dydt) const {
    dydt << y.tail<2>(), -(K() * y.head<2>() + C() * y.tail<2>()).cwiseQuotient(mass());
  }
  void force(double /*t*/, const Dofs& q, const Dofs& v, Dofs& f) const { f = -K() * q - C() * v; }
  void stiffness(double /*t*/, const Dofs&, const Dofs&, DofMatrix& matrix) const { matrix = K(); }
  void damping(double /*t*/, const Dofs&, const Dofs&, DofMatrix& matrix) const { matrix = C(); }
};

double of_motion(const Method& method) {
  const MotionMap& map = *method.amplification->motion;
  const auto coefficient = [](const Polynomial& p, std::size_t j) {
    return j < p.size() ? static_cast<double>(p[j]) : 0.0;
  };
  double worst = 0;
  for (const auto& [stiffer, damped] : {std::pair{0.05, 0.1}, {0.3, 0.05}, {0.1, 0.4}}) {
    const TwoBodies bodies{stiffer, damped};
    const Problem problem{.id = "two_bodies",
                          .states = {"q1", "q2", "v1", "v2"},
                          .y0 = Eigen::Vector4d(1, -0.3, 0.2, 0.5),
                          .t_end = 1,
                          .system = AnySystem(bodies)};
    const std::size_t degree = map.degree();
    const auto states = path(method, problem, degree + 2);
    if (states.size() < degree + 2) return infinity;
    const Eigen::Matrix2d M = bodies.mass().asDiagonal(), C = bodies.C(), K = bodies.K(),
                          D = C.diagonal().asDiagonal();
    // From the second state on: the first has an acceleration of its own choice.
    for (const Eigen::Index part : {0, 2}) {
      Eigen::Vector2d defect = Eigen::Vector2d::Zero(), size = defect;
      for (std::size_t j = 0; j <= degree; ++j)
        for (const auto& [c, A] : {std::pair<double, const Eigen::Matrix2d*>{coefficient(map.inertia, j), &M},
                                   {coefficient(map.damper, j), &C},
                                   {coefficient(map.lumped, j), &D},
                                   {coefficient(map.spring, j), &K}}) {
          const Eigen::Vector2d term = c * (*A * states[1 + j].segment<2>(part));
          defect += term;
          size += term.cwiseAbs();
        }
      worst = std::max(worst, defect.cwiseAbs().cwiseQuotient(size).maxCoeff());
    }
  }
  return worst;
}

}  // namespace

double step_defect(const Method& method) {
  if (!method.bind || !method.fixed_step || !method.amplification || method.amplification->measured) return 0;
  const Amplification& amplification = *method.amplification;
  const double defect = amplification.motion ? of_motion(method)
                        : amplification.in_z && amplification.in_z->coefficients().size() > 2
                            ? of_recurrence(method)
                            : of_one_step(method);
  return std::isnan(defect) ? infinity : defect;
}

}  // namespace hmax
