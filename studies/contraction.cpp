#include "studies/contraction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/method.hpp"

namespace hmax {

namespace {

/// y' = f(y) of one number.
struct OneNumber {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  bool cubic = true;

  [[nodiscard]] Eigen::Index dim() const { return 1; }
  void rhs(double, const State& y, State& dydt) const {
    dydt[0] = cubic ? -y[0] * y[0] * y[0] : -std::atan(y[0]);
  }
  void jacobian(double, const State& y, Jacobian& J) const {
    J.resize(1, 1);
    J(0, 0) = cubic ? -3 * y[0] * y[0] : -1 / (1 + y[0] * y[0]);
  }
};

/// One step, or NaN where it was not solved.
double stepped(const Method& method, bool cubic, double y0, double h) {
  const Problem problem{.id = "one number",
                        .y0 = Eigen::VectorXd::Constant(1, y0),
                        .t_end = h,
                        .system = AnySystem(OneNumber{cubic})};
  const RunRecord record = method.bind(problem).run({.t_end = h, .h = h}, {});
  return record.outcome == Outcome::reached_end ? record.y[0] : NAN;
}

}  // namespace

std::vector<Contraction> contractions(const std::vector<std::string>& methods) {
  constexpr double starts[] = {0, 0.25, 0.5, 1, 1.01, 1.5, 2}, steps[] = {0.1, 1, 10, 100};
  std::vector<Contraction> all;
  for (const std::string& id : methods) {
    const Method method = find_method(id);
    Contraction found{.method = id};
    for (const bool cubic : {true, false})
      for (const double h : steps) {
        std::vector<std::pair<double, double>> pairs;  // before and after
        for (const double start : starts) {
          pairs.emplace_back(start, stepped(method, cubic, start, h));
          if (std::isnan(pairs.back().second)) ++found.unsolved;
        }
        double& most = cubic ? found.cubic : found.arctan;
        for (const auto& [a, next_a] : pairs)
          for (const auto& [b, next_b] : pairs)
            if (a < b) most = std::fmax(most, std::abs(next_b - next_a) / (b - a));
      }
    // The steps are solved to a tolerance.
    found.nearer = std::max(found.cubic, found.arctan) <= 1 + 1e-6;
    all.push_back(found);
  }
  return all;
}

}  // namespace hmax
