#include "studies/particle_limits.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "analysis/statics/static_solution.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

const ParticleBody phantom{.mesh = "phantom"};

std::vector<Method> explicit_ones() {
  return {find_method("explicit_euler"), find_method("rk4"), find_method("symplectic_euler")};
}

TEST(ParticleBody, HasOneMassForEveryParticleAndNoWeight) {
  const Problem problem = particle_problem(phantom);
  const TissueBody& body = *problem.body;
  EXPECT_NEAR(body.point_mass().minCoeff(), phantom.particle_mass, 1e-15);
  EXPECT_NEAR(body.point_mass().maxCoeff(), phantom.particle_mass, 1e-15);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(body.dofs());
  body.force(0, f, f, f);
  EXPECT_LT(f.norm(), 1e-12);
}

TEST(ParticleBody, HasSpringsThatAreAsStiffAsItsYoungsModulus) {
  ParticleBody stiff = phantom;
  stiff.young *= 3;
  EXPECT_NEAR(mean_spring_stiffness(stiff), 3 * mean_spring_stiffness(phantom), 1e-9);
}

TEST(StepsASecond, FallWithTheRootOfMassOverStiffnessWithoutDamping) {
  const auto methods = explicit_ones();
  const auto rates = stable_step_rates(methods, phantom);
  ParticleBody other = phantom;
  other.particle_mass *= 8;
  other.young *= 2;
  const auto fewer = stable_step_rates(methods, other);
  EXPECT_TRUE(std::isinf(rates[0]) && std::isinf(fewer[0]));
  for (std::size_t i : {1, 2}) EXPECT_NEAR(rates[i] / fewer[i], 2, 1e-9) << methods[i].id;
}

TEST(StepsASecond, OfExplicitEulerDoNotDependOnTheMassOfWhatSwings) {
  // h < gamma / kappa = c / k of the fastest mode: k / c steps, in which the mass cancels.
  const std::vector<Method> euler{find_method("explicit_euler")};
  ParticleBody damped = phantom;
  damped.damper = 1;
  const double light = stable_step_rates(euler, damped).front();
  damped.particle_mass *= 30;
  EXPECT_NEAR(stable_step_rates(euler, damped).front(), light, 1e-9 * light);
  // With dampers along the springs c / k is the same for all.
  ParticleBody along = phantom;
  along.damper_time = 0.01;
  along.particle_mass = 10;
  EXPECT_NEAR(stable_step_rates(euler, along).front(), 100, 1e-6);
}

TEST(TheStiffestBody, IsTheOneWhoseLimitIsTheRate) {
  for (const char* id : {"rk4", "symplectic_euler"}) {
    const Method method = find_method(id);
    ParticleBody body = phantom;
    body.young = stiffest_stable(method, phantom, 400, 1e2, 1e6);
    EXPECT_NEAR(stable_step_rates({&method, 1}, body).front(), 400, 0.3) << id;
  }
  EXPECT_EQ(stiffest_stable(find_method("explicit_euler"), phantom, 400, 1e2, 1e6), 1e2);
  EXPECT_EQ(stiffest_stable(find_method("rk4"), phantom, 1e6, 1e2, 1e4), 1e4);
}

TEST(TheHeaviestParticle, HasAnEquilibriumAndALittleMoreOverturnsAnElement) {
  const double heaviest = heaviest_hanging(phantom);
  const auto least_volume = [&](double mass) {
    ParticleBody body = phantom;
    body.particle_mass = mass;
    const auto count = static_cast<double>(particle_problem(body).body->mesh().point_count());
    const Problem problem =
        make_problem("mass_spring@phantom",
                     {.parameters = {{"E", body.young}, {"mass", mass * count}, {"equal_masses", 1}}});
    const StaticSolution found =
        solve_static(static_model(problem, 1), {.load_steps = 20}, [] { return 0.0; });
    return found.converged ? problem.body->least_volume(0, found.q).first : -1;
  };
  EXPECT_GT(least_volume(0.98 * heaviest), 0);
  EXPECT_LE(least_volume(1.03 * heaviest), 0);
  // What matters is mass over E.
  ParticleBody stiff = phantom;
  stiff.young *= 10;
  EXPECT_NEAR(heaviest_hanging(stiff) / heaviest, 10, 0.2);
}

TEST(ScaledEigenvalues, OfOscillationsLieOnALineAndReachTheLimitOfSymplecticEuler) {
  // q'' + alpha q' + kappa q = 0 has Re lambda = -alpha / 2; without damping omega h = 2 at the limit.
  const std::vector<Method> symplectic{find_method("symplectic_euler")};
  const double h = 1 / stable_step_rates(symplectic, phantom).front();
  double largest = 0;
  for (const auto z : scaled_eigenvalues(phantom, h)) largest = std::max(largest, std::abs(z));
  EXPECT_NEAR(largest, 2, 1e-6);
  ParticleBody damped = phantom;
  damped.damper = 0.01;
  const double alpha =
      damped.damper /
      (damped.particle_mass * static_cast<double>(particle_problem(phantom).body->point_mass().size()));
  for (const auto z : scaled_eigenvalues(damped, h)) EXPECT_NEAR(z.real(), -h * alpha / 2, 1e-9 * largest);
}

TEST(LogarithmicPlaces, AreDecadesWhereTheyAreAskedForDecades) {
  const std::vector<double> places = logarithmic_places(0.01, 1000, 6);
  ASSERT_EQ(places.size(), 6U);
  for (std::size_t i = 0; i < places.size(); ++i)
    EXPECT_NEAR(places[i] / std::pow(10, static_cast<double>(i) - 2), 1, 1e-14) << i;
}

}  // namespace
}  // namespace hmax
