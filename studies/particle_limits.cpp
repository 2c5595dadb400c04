#include "studies/particle_limits.hpp"

#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "analysis/statics/static_solution.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "problems/mesh/files/mesh_names.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

Problem weighing(const ParticleBody& body, double g) {
  const double mass = body.particle_mass * static_cast<double>(mesh_by_name(body.mesh).point_count());
  return make_problem(tissue_id("mass_spring", body.mesh, "gravity"),
                      {.parameters = {{"E", body.young},
                                      {"mass", mass},
                                      {"equal_masses", 1},
                                      {"alpha", body.damper / mass},
                                      {"damper", body.damper_time},
                                      {"g", g}}});
}

bool hangs(const ParticleBody& body) {
  const Problem problem = weighing(body, 9.81);
  const StaticSolution solution =
      solve_static(static_model(problem, 1), {.load_steps = 10}, [] { return 0.0; });
  return solution.converged && problem.body->least_volume(0, solution.q).first > 0;
}

/// Halves the logarithm of an interval until its ends are within a factor; `holds` at `low`, not at `high`.
template <class Holds>
double last_that(const Holds& holds, double low, double high, double factor) {
  while (high > factor * low) {
    const double middle = std::sqrt(low * high);
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

Problem particle_problem(const ParticleBody& body) { return weighing(body, 0); }

std::vector<std::complex<double>> scaled_eigenvalues(const ParticleBody& body, double h) {
  std::vector<std::complex<double>> scaled;
  for (const auto lambda : linearised(particle_problem(body)).modes.spectrum.lambda)
    scaled.push_back(h * lambda);
  return scaled;
}

std::vector<double> logarithmic_places(double low, double high, int points) {
  std::vector<double> places;
  for (int i = 0; i < points; ++i)
    places.push_back(low * std::pow(high / low, static_cast<double>(i) / (points - 1)));
  return places;
}

double mean_spring_stiffness(const ParticleBody& body) {
  const TetMesh mesh = mesh_by_name(body.mesh);
  const std::vector<double> stiffness = edge_stiffness(mesh, edge_table(mesh), {&body.young, 1});
  return std::accumulate(stiffness.begin(), stiffness.end(), 0.0) / static_cast<double>(stiffness.size());
}

std::vector<double> stable_step_rates(std::span<const Method> methods, const ParticleBody& body) {
  const Problem problem = particle_problem(body);
  const Linearised near = linearised(problem);
  std::vector<double> rates;
  for (const Method& method : methods) {
    const Prediction row = predict(method, near);
    if (!row.h_max) throw InputError(fmt::format("{} on a body of springs: {}", method.id, row.note));
    rates.push_back(1 / *row.h_max);
  }
  return rates;
}

double stiffest_stable(const Method& method, ParticleBody body, double rate, double softest,
                       double stiffest) {
  // Dampers can make the limit that of a time, which a rate then meets to rounding.
  const auto stable = [&](double young) {
    body.young = young;
    return stable_step_rates({&method, 1}, body).front() <= rate * (1 + 1e-6);
  };
  if (!stable(softest)) return softest;
  if (stable(stiffest)) return stiffest;
  return last_that(stable, softest, stiffest, 1.001);
}

double heaviest_hanging(ParticleBody body) {
  const auto light = [&](double mass) {
    body.particle_mass = mass;
    return hangs(body);
  };
  double mass = body.particle_mass;
  for (int halved = 0; !light(mass); mass /= 2)
    if (++halved > 60) throw InputError("a body of springs does not hang at any mass; give it a support");
  double high = 2 * mass;
  for (int doubled = 0; light(high); high *= 2)
    if (++doubled > 60) return high;
  return last_that(light, high / 2, high, 1.01);
}

}  // namespace hmax
