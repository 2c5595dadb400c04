#include "studies/motion_identification.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Cholesky>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

constexpr double measured_for = 0.5, every = 0.01;  // [s]

/// E and alpha as the logarithms that are fitted.
using Unknowns = Eigen::Vector2d;

Problem pressed_phantom(std::string_view model, std::string_view mesh, const Unknowns& u) {
  return make_problem(
      tissue_id(model, mesh, "press"),
      {.parameters = {{"E", std::exp(u[0])}, {"alpha", std::exp(u[1])}, {"force", 0.2}, {"mass", 1.45}}});
}

/// Displacements of every free point every 10 ms, one after the other; empty where the run ends early.
Eigen::VectorXd displacements(const Problem& problem, const char* method, const RunSpec& spec) {
  const Eigen::Index n = problem.body->dofs();
  std::vector<double> all;
  const RunRecord record =
      find_method(method).bind(problem).run(spec, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
        all.insert(all.end(), y.data(), y.data() + n);
      });
  if (record.outcome != Outcome::reached_end) return {};
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

FittedMotion fitted(std::string_view model, std::string_view mesh, const Eigen::VectorXd& measured) {
  FittedMotion fit{.model = std::string(model)};
  const auto residual = [&](const Unknowns& u) -> Eigen::VectorXd {
    ++fit.runs;
    const Eigen::VectorXd x = displacements(pressed_phantom(model, mesh, u), "rk4",
                                            {.t_end = measured_for, .h = 0.002, .every = every});
    if (x.size() != measured.size()) return Eigen::VectorXd::Constant(measured.size(), INFINITY);
    return x - measured;
  };
  Unknowns u(std::log(1e4), std::log(2.0));
  Eigen::VectorXd r = residual(u);
  if (!r.allFinite()) throw InputError("the guess of a motion is not stable; this is a defect");
  for (int iteration = 0; iteration < 20; ++iteration) {
    constexpr double by = 1e-4;
    Eigen::MatrixXd J(r.size(), 2);
    for (int k = 0; k < 2; ++k) J.col(k) = (residual(u + by * Unknowns::Unit(k)) - r) / by;
    Unknowns step = -(J.transpose() * J).ldlt().solve(J.transpose() * r);
    step *= std::min(1.0, 1 / step.cwiseAbs().maxCoeff());
    Eigen::VectorXd next = residual(u + step);
    while (!(next.squaredNorm() < r.squaredNorm()) && step.norm() > 1e-6) next = residual(u + (step *= 0.5));
    if (!(next.squaredNorm() < r.squaredNorm())) break;
    u += step;
    r = next;
    if (step.norm() < 1e-5) break;
  }
  fit.young = std::exp(u[0]);
  fit.alpha = std::exp(u[1]);
  fit.misfit = r.norm() / measured.norm();
  return fit;
}

}  // namespace

IdentifiedMotion identified_motion(std::string_view mesh, std::uint64_t seed) {
  IdentifiedMotion found;
  const Unknowns truth(std::log(found.young), std::log(found.alpha));
  Eigen::VectorXd measured =
      displacements(pressed_phantom("fem_green", mesh, truth), "dop_853",
                    {.t_end = measured_for, .adaptive = true, .rtol = 1e-8, .atol = 1e-10, .every = every});
  std::mt19937_64 random(seed);
  std::normal_distribution<double> off(0, found.noise * measured.cwiseAbs().maxCoeff());
  for (double& value : measured) value += off(random);
  found.numbers = measured.size();
  for (const char* model : {"fem_green", "mass_spring"}) found.fits.push_back(fitted(model, mesh, measured));
  return found;
}

}  // namespace hmax
