/// Limits on meshes, predicted from their modes and observed by runs.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "analysis/amplification/amplification.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/chosen_methods.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/modes/mode_curve.hpp"
#include "limits/modes/mode_range.hpp"
#include "limits/predict.hpp"
#include "limits/verification.hpp"
#include "problems/tissue/body.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

using Numbers = std::vector<std::pair<std::string, double>>;

/// Without its weight unless g is given.
Problem mesh_problem(const std::string& id, Numbers numbers) {
  numbers.insert(numbers.begin(), {"g", 0});
  return make_problem(id, {.parameters = std::move(numbers)});
}

/// Every finite limit is observed within half a percent, and every "unbounded" holds.
void expect_observed(const Problem& problem, const std::vector<std::string>& methods) {
  const Linearised near = linearised(problem);
  ASSERT_TRUE(near.point.model.mechanical) << problem.id;
  for (const std::string& name : methods) {
    const Method method = find_method(name);
    Prediction row = predict(method, near);
    verify(row, method, problem, near);
    const std::string where = problem.id + " " + name + ": " + row.note;
    ASSERT_TRUE(row.h_max) << where;
    if (row.bound == Bound::every_step) continue;
    ASSERT_TRUE(row.observed) << where;
    EXPECT_TRUE(row.observed->agrees) << where;
    if (std::isfinite(*row.h_max)) {
      EXPECT_LE(std::abs(row.observed->gap), 5e-3) << where;
    }
  }
}

const std::vector<std::string> some_methods{
    "rk4",           "bogacki_shampine_32", "adams_bashforth_3", "symplectic_euler", "central_difference",
    "stormer_verlet"};

/// Of all kinds: growth of R(z), of a root that only methods of several steps have, of positions and
/// velocities.
const std::vector<std::string> one_of_each{
    "rk3_kutta",         "rk4",   "dormand_prince_54", "adams_bashforth_3",
    "abm_pece_6",        "rkc_2", "symplectic_euler",  "stormer_verlet",
    "central_difference"};

TEST(MeshLimits, AreObservedWithoutDamping) {
  expect_observed(
      mesh_problem("fem_cauchy@cube:n=2", {}),
      {"symplectic_euler", "central_difference", "velocity_verlet", "stormer_verlet", "explicit_newmark"});
  expect_observed(mesh_problem("fem_cauchy@phantom", {{"alpha", 0}}), one_of_each);
  expect_observed(mesh_problem("mass_spring@phantom", {{"alpha", 0}}), {"rk4", "stormer_verlet"});
}

TEST(MeshLimits, OfFibresHaveAClosedFormAndAreObserved) {
  // One tetrahedron of three equal edges L along the axes, hardly any stiffness but that of fibres along x:
  // two opposite forces V E_f / L^2 u on points of mass rho V / 4, so that omega^2 = 8 E_f / (rho L^2).
  const Scratch folder;
  const std::string file = (folder / "one.msh").string();
  write_text(file,
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 0.01 0 0\n3 0 0.01 0\n4 0 0 0.01\n"
             "$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n");
  const double fibres = 2e4, rho = 1000, exact = 2 / std::sqrt(8 * fibres / (rho * 1e-4));
  for (const char* model :
       {"fem_green", "fem_cauchy", "fem_corotational", "fem_neo_hookean", "fem_nodal_pressure"}) {
    const Problem problem =
        make_problem(fmt::format("{}@{}", model, file), {.parameters = {{"g", 0},
                                                                        {"support", 0},
                                                                        {"E", 1e-4},
                                                                        {"nu", 0},
                                                                        {"rho", rho},
                                                                        {"fibre_E", fibres},
                                                                        {"fibre_x", -3}},
                                                         .unit = 1});
    const Prediction row = predict(find_method("central_difference"), linearised(problem));
    ASSERT_TRUE(row.h_max) << model << ": " << row.note;
    EXPECT_NEAR(*row.h_max / exact, 1, 1e-6) << model;
  }
  expect_observed(mesh_problem("fem_cauchy@cube:n=2", {{"fibre_E", 5e4}, {"fibre_x", 1}, {"fibre_z", 2}}),
                  some_methods);
}

TEST(MeshLimits, SayThatTheStiffnessOfFibresJumpsAtRestAndNotUnderALoad) {
  const auto state = [](const std::string& model, double g) {
    return linearised(make_problem(model + "@cube:n=1",
                                   {.parameters = {{"g", g}, {"fibre_E", 2e4}, {"fibre_x", 1}}}))
        .point.state;
  };
  EXPECT_NE(state("fem_green", 0).find("fibres buckle from here on"), std::string::npos);
  EXPECT_EQ(state("fem_green", 9.81).find("fibres"), std::string::npos);
  EXPECT_EQ(state("fem_cauchy", 0).find("fibres"), std::string::npos) << "linear ones push too";
}

TEST(MeshLimits, AreObservedOfElementsOfTenNodes) {
  expect_observed(mesh_problem("fem_quadratic@cube:n=2", {}), {"rk4", "symplectic_euler", "stormer_verlet"});
  expect_observed(mesh_problem("fem_quadratic@cube:n=1", {{"alpha", 4}, {"beta", 0.001}}), one_of_each);
}

TEST(MeshLimits, AreObservedWithRayleighDamping) {
  expect_observed(mesh_problem("fem_cauchy@phantom", {{"alpha", 4}, {"beta", 0.001}}), one_of_each);
}

// The mode that sets the limit is damped by some 1e5 1/s and creeps back within a second, as all others do:
// what grows begins small beside that, and would be waited for a hundred thousand steps.
TEST(MeshLimits, AreObservedCloselyWhereDampingIsFast) {
  for (const auto& [mesh, beta] :
       {std::pair{"ball:n=2", 0.1}, std::pair{"ball:n=2", 1.0}, std::pair{"phantom", 1.0}}) {
    const Problem problem = mesh_problem(std::string("fem_cauchy@") + mesh, {{"beta", beta}});
    const Linearised near = linearised(problem);
    for (const char* name : {"central_difference", "velocity_verlet", "stormer_verlet", "symplectic_euler",
                             "adams_bashforth_2", "adams_bashforth_4", "newmark:beta=0.1,gamma=0.6"}) {
      const Method method = find_method(name);
      Prediction row = predict(method, near);
      verify(row, method, problem, near);
      ASSERT_TRUE(row.observed) << name;
      EXPECT_TRUE(row.observed->agrees) << name << " " << beta;
      EXPECT_LE(std::abs(row.observed->gap), 5e-4) << name << " " << beta;
      EXPECT_LE(row.observed->steps, 2000) << name << " " << beta;
    }
  }
}

// Explicit Euler grows by 5e-8 a step at 1.001 of its limit, a root of the Adams methods begins as small as
// rounding, and beyond the limit of symplectic Euler the stiffening of the body catches its growth.
TEST(MeshLimits, AreObservedWhereABodyHangsInItsWeight) {
  std::vector<std::string> methods = one_of_each;
  for (const char* more : {"explicit_euler", "rk2_heun", "adams_bashforth_5", "abm_pec_6"})
    methods.push_back(more);
  expect_observed(mesh_problem("fem_green@phantom", {{"g", 9.81}, {"alpha", 4}}), methods);
}

TEST(MeshLimits, AreObservedWithDampersAlongSprings) {
  // Without weight such dampers are proportional to the stiffness.
  const Problem problem = mesh_problem("mass_spring@phantom", {{"g", 9.81}, {"alpha", 4}, {"damper", 0.01}});
  ASSERT_EQ(linearised(problem).point.model.mechanical->damping, Damping::general);
  std::vector<std::string> methods = one_of_each;
  methods.push_back("explicit_euler");
  methods.push_back("newmark:beta=0.1,gamma=0.6");
  expect_observed(problem, methods);
}

// A hanging body is stiffened by its weight, which the part that is solved for does not know.
TEST(MeshLimits, OfMethodsOfTwoPartsAreUnknownUnderALoadWithARemedyThatHolds) {
  const Method method = find_method("imex_euler");
  const auto row_of = [&](const std::string& model, double g) {
    const Problem problem = mesh_problem(model + "@cube:n=2", {{"g", g}, {"alpha", 4}});
    return predict(method, linearised(problem));
  };
  const Prediction hanging = row_of("fem_green", 9.81);
  EXPECT_EQ(hanging.bound, Bound::unknown);
  EXPECT_NE(hanging.note.find("at rest without load (g of 0) or with linear tissue"), std::string::npos);
  EXPECT_NE(row_of("fem_green", 0).bound, Bound::unknown);
  EXPECT_NE(row_of("fem_cauchy", 9.81).bound, Bound::unknown);
}

/// Limits go with the root of the stiffness.
TEST(MeshLimits, OfABodyThreePercentSofterOrStifferAreContradicted) {
  const auto body = [](double E) { return mesh_problem("fem_green@phantom", {{"alpha", 4}, {"E", E}}); };
  const Linearised claimed = linearised(body(5000));
  for (const double share : {0.97, 1.03}) {
    const Problem real = body(5000 * share);
    const Linearised near = linearised(real);
    for (const char* name : {"explicit_euler", "rk4", "adams_bashforth_5", "symplectic_euler"}) {
      const Method method = find_method(name);
      Prediction row = predict(method, claimed);
      verify(row, method, real, claimed);
      ASSERT_TRUE(row.observed) << name;
      EXPECT_FALSE(row.observed->agrees) << name << " " << share;
      EXPECT_TRUE(row.observed->contradicts()) << name << " " << share;
      EXPECT_NE(row.note.find(share < 1 ? "do not grow" : "0.999 of it grow"), std::string::npos) << row.note;
      const double truth = *predict(method, near).h_max;
      EXPECT_NEAR(row.observed->h_max, truth, 2e-3 * truth) << name << " " << share;
    }
  }
}

/// The same model once with all modes and once with its ends alone.
TEST(MeshLimits, OfTheEndsAloneAreThoseOfAllModesOrBelow) {
  for (const Numbers& damping : {Numbers{}, Numbers{{"alpha", 3}}, Numbers{{"alpha", 3}, {"beta", 0.002}}}) {
    const Problem problem = mesh_problem("fem_cauchy@phantom", damping);
    const Linearised all = linearised(problem);
    Linearised ends = all;
    ends.modes.spectrum = {};
    const auto rayleigh = rayleigh_coefficients(*all.point.model.mechanical).value();
    ends.modes.curve = DampingCurve{.alpha = rayleigh[0],
                                    .beta = rayleigh[1],
                                    .kappa_min = all.modes.spectrum.mechanical.front().kappa,
                                    .kappa_max = all.modes.spectrum.mechanical.back().kappa};
    for (const double kappa : {ends.modes.curve->kappa_min, ends.modes.curve->kappa_max}) {
      ends.modes.spectrum.mechanical.push_back(ends.modes.curve->at(kappa));
      for (const Complex lambda : eigenvalues_of(ends.modes.curve->at(kappa)))
        ends.modes.spectrum.lambda.push_back(lambda);
    }
    for (const std::string& name : some_methods) {
      const Method method = find_method(name);
      const Prediction exact = predict(method, all), bound = predict(method, ends);
      // Methods that solve for a part of the damping alone have no curve: the row says so.
      if (!bound.h_max) {
        EXPECT_NE(bound.note.find("take explicit_newmark"), std::string::npos) << name;
        continue;
      }
      ASSERT_TRUE(exact.h_max) << name;
      if (bound.note.empty()) {
        EXPECT_NEAR(*bound.h_max, *exact.h_max, 1e-6 * *exact.h_max) << name;
      } else {
        EXPECT_LE(*bound.h_max, *exact.h_max * (1 + 1e-9)) << name;
        EXPECT_GE(*bound.h_max, 0.9 * *exact.h_max) << name;
      }
    }
  }
}

/// A body in its weight, whose stiffness is no longer that which damps it.
Problem hanging(const std::string& id, double beta) {
  return mesh_problem(id, {{"g", 9.81}, {"alpha", 1}, {"beta", beta}});
}

// From weakly damped to creeping fast modes.
constexpr double betas[]{1e-4, 1e-3, 0.02};

TEST(MeshLimits, OfTheLargestEigenvaluesAreThoseOfAllOrBelow) {
  int exact = 0;
  for (const double beta : betas) {
    const Problem problem = hanging("fem_green@phantom", beta);
    Linearised all = linearised(problem);
    ASSERT_EQ(all.point.model.mechanical->damping, Damping::general);
    ASSERT_FALSE(all.modes.range);
    Linearised largest = all;
    largest.modes.spectrum = {};
    ASSERT_TRUE(set_range(largest.point.model, largest.modes, 20));
    for (const char* name :
         {"explicit_euler", "rk2_heun", "rk4", "dormand_prince_54", "adams_bashforth_3", "rkc_2",
          "symplectic_euler", "stormer_verlet", "newmark", "implicit_euler", "bdf_3"}) {
      const Method method = chosen_methods_and_formulas({name}, {problem}).methods.front();
      const Prediction truth = predict(method, all), bound = predict(method, largest);
      const std::string where = fmt::format("{} with beta {}: {}", name, beta, bound.note);
      ASSERT_TRUE(truth.h_max && bound.h_max) << where;
      EXPECT_EQ(bound.note.empty(), !bound.unstable_from) << where;
      if (bound.unstable_from) {
        EXPECT_LE(*bound.h_max, *truth.h_max * (1 + 1e-9)) << where;
        EXPECT_GE(*bound.unstable_from, *truth.h_max * (1 - 1e-9)) << where;
        continue;
      }
      ++exact;
      if (std::isinf(*truth.h_max))
        EXPECT_EQ(*bound.h_max, *truth.h_max) << where;
      else
        EXPECT_NEAR(*bound.h_max, *truth.h_max, 1e-7 * *truth.h_max) << where;
    }
  }
  EXPECT_GE(exact, 20);
}

TEST(MeshLimits, OfTheLargestEigenvaluesAreObserved) {
  for (const double beta : betas) {
    const Problem problem = hanging("fem_green@cube:n=5", beta);
    const Linearised near = linearised(problem);
    ASSERT_TRUE(near.modes.range);
    for (const char* name : {"rk4", "symplectic_euler", "stormer_verlet"}) {
      const Method method = find_method(name);
      Prediction row = predict(method, near);
      ASSERT_FALSE(row.unstable_from) << name << " " << beta;
      verify(row, method, problem, near);
      ASSERT_TRUE(row.observed) << name << " " << row.note;
      EXPECT_TRUE(row.observed->agrees) << name << " " << beta << " " << row.note;
    }
  }
}

TEST(MeshLimits, AtRestAreThoseOfABodyWithoutItsWeight) {
  const Problem loaded = mesh_problem("fem_green@phantom", {{"g", 9.81}, {"alpha", 4}, {"beta", 0.001}}),
                free = mesh_problem("fem_green@phantom", {{"alpha", 4}, {"beta", 0.001}});
  const Method method = find_method("rk4");
  const Linearised at_rest = linearised(loaded, AskedState::rest), near = linearised(free);
  EXPECT_EQ(at_rest.point.kind, StateKind::rest);
  EXPECT_FALSE(at_rest.point.at_equilibrium);
  EXPECT_EQ(near.point.kind, StateKind::equilibrium);
  EXPECT_DOUBLE_EQ(predict(method, at_rest).h_max.value(), predict(method, near).h_max.value());
  EXPECT_EQ(predict(method, at_rest).state_kind, StateKind::rest);
  EXPECT_EQ(linearised(loaded).point.kind, StateKind::equilibrium);
}

TEST(MeshLimits, BesideALoadThatNeverSettlesAreOfAnEquilibriumWhereForcesBalance) {
  const auto point_of = [](Numbers numbers) {
    return operating_point(make_problem("fem_green/breathing@cube:n=2", {.parameters = std::move(numbers)}));
  };
  for (const Numbers& balanced : {Numbers{}, Numbers{{"beta", 1e-3}}, Numbers{{"force_z:points:14", 0}}}) {
    const OperatingPoint point = point_of(balanced);
    EXPECT_EQ(point.kind, StateKind::equilibrium);
    EXPECT_TRUE(point.at_equilibrium);
  }
  const OperatingPoint pushed = point_of({{"force_z:points:14", 0.5}});
  EXPECT_EQ(pushed.kind, StateKind::rest);
  EXPECT_FALSE(pushed.at_equilibrium);
  EXPECT_NE(pushed.status.find("never settles"), std::string::npos) << pushed.status;
}

TEST(MeshLimits, OfLargeMeshesNeedNoDenseMatrix) {
  const Problem problem = mesh_problem("fem_cauchy@ball:n=6", {{"alpha", 3}});
  ASSERT_GT(problem.body->dofs(), most_dense_modes);
  const Linearised near = linearised(problem);
  ASSERT_TRUE(near.modes.curve);
  const Prediction row = predict(find_method("symplectic_euler"), near);
  ASSERT_TRUE(row.h_max);
  // 2 / omega without damping; the kick takes some of it away.
  EXPECT_NEAR(*row.h_max, 2 / std::sqrt(near.modes.curve->kappa_max), 0.01 * *row.h_max);
}

/// Beyond most_cheaply_factored degrees of freedom a step takes long: a few of them tell.
TEST(MeshLimits, OfLargeMeshesAreObservedInAFewSteps) {
  const auto body = [](double E) { return mesh_problem("fem_cauchy@cube:n=19", {{"E", E}}); };
  const Problem problem = body(5000);
  ASSERT_GT(problem.body->dofs(), most_cheaply_factored);
  const Linearised near = linearised(problem);
  for (const char* name : {"symplectic_euler", "stormer_verlet", "rk4", "bogacki_shampine_32"}) {
    const Method method = find_method(name);
    Prediction row = predict(method, near);
    const Prediction predicted = row;
    verify(row, method, problem, near);
    ASSERT_TRUE(row.observed) << name << ' ' << row.note;
    EXPECT_TRUE(row.observed->agrees) << name << ' ' << row.note;
    EXPECT_LE(std::abs(row.observed->gap), 3e-4) << name;
    EXPECT_LE(row.observed->steps, 24) << name;
    row = predicted;
    verify(row, method, body(5000 * 1.02), near);
    ASSERT_TRUE(row.observed) << name;
    EXPECT_TRUE(row.observed->contradicts()) << name;
    EXPECT_NEAR(row.observed->h_max, *predicted.h_max / std::sqrt(1.02), 5e-4 * *predicted.h_max) << name;
  }
}

}  // namespace
}  // namespace hmax
