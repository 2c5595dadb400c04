/// Bodies on meshes as problems: every method steps them, and linear ones move as their modes say.
#include "catalogue/models/tissue_problem.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "bench/timing/reference.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/body_summary.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "limits/linearised_problem.hpp"
#include "problems/tissue/body.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

RunRecord run(const Problem& problem, const std::string& method, RunSpec spec) {
  return find_method(method).bind(problem).run(spec, {});
}

/// A small cube that is pressed hard enough to show what is not linear, and damped.
Problem pressed_cube(const std::string& model) {
  return make_problem(model + "/press@cube:n=2",
                      {.parameters = {{"E", 4000}, {"force", 0.3}, {"alpha", 2}, {"beta", 1e-3}}});
}

TEST(TissueProblem, IsLinearOfSmallStrainsWithoutToolOrSkinAlone) {
  const auto is_linear = [](const char* name, double skin) {
    return has_linear_forces(*make_problem(name, {.parameters = {{"skin", skin}}}).body);
  };
  EXPECT_TRUE(is_linear("fem_cauchy@cube:n=1", 0));
  EXPECT_TRUE(is_linear("fem_cauchy/press@cube:n=1", 0));
  EXPECT_FALSE(is_linear("fem_cauchy@cube:n=1", 10));
  EXPECT_FALSE(is_linear("fem_cauchy/tool@cube:n=1", 0));
  EXPECT_FALSE(is_linear("fem_green@cube:n=1", 0));
  EXPECT_FALSE(is_linear("fem_green/tool@cube:n=1", 10));
}

TEST(TissueProblem, IsSteppedByEveryMethodToTheSameEnd) {
  const Problem problem = pressed_cube("fem_green");
  ASSERT_GT(problem.body->dofs(), 30);
  constexpr double t_end = 0.02;
  const VectorXd expected =
      run(problem, "dop_853", {.t_end = t_end, .adaptive = true, .rtol = 1e-11, .atol = 1e-14}).y;
  const double size = expected.head(problem.body->dofs()).cwiseAbs().maxCoeff();
  ASSERT_GT(size, 1e-5);
  for (const Method& method : choose_methods({"all"}, {problem})) {
    // It factors its factors again in a second iteration, which only linear equations do without.
    if (method.id == "odeint_implicit_euler") continue;
    RunSpec spec{.t_end = t_end, .h = 2.5e-4};
    if (!method.fixed_step) spec = {.t_end = t_end, .adaptive = true, .rtol = 1e-6, .atol = 1e-9};
    const RunRecord end = method.bind(problem).run(spec, {});
    ASSERT_EQ(end.outcome, Outcome::reached_end) << method.id << ' ' << end.t << ' ' << end.note;
    // First-order methods err by a few per cent at this step.
    const double error = (end.y - expected).head(problem.body->dofs()).cwiseAbs().maxCoeff() / size;
    EXPECT_LT(error, method.order == 1 ? 0.05 : 5e-3) << method.id;
  }
}

TEST(TissueProblem, OfSmallStrainMovesAsTheSumOfItsModes) {
  for (const double beta : {0.0, 1e-3}) {
    const Problem problem = make_problem("fem_cauchy@cube:n=2",
                                         {.material = "liver:male_normal", .parameters = {{"beta", beta}}});
    ASSERT_TRUE(problem.has_exact_solution);
    const Reference reference = make_reference(problem, 0.3);
    const VectorXd exact = reference.at(0.3);
    const VectorXd found =
        run(problem, "dop_853", {.t_end = 0.3, .adaptive = true, .rtol = 1e-12, .atol = 1e-14}).y;
    EXPECT_LT((found - exact).norm(), 1e-8 * exact.norm()) << beta;
    const VectorXd implicit = run(problem, "radau_iia_5", {.t_end = 0.3, .h = 1e-3}).y;
    EXPECT_LT((implicit - exact).norm(), 1e-5 * exact.norm()) << beta;
  }
}

TEST(TissueProblem, HasOneMotionWhateverSolvesItsEquations) {
  const Problem problem = pressed_cube("fem_neo_hookean");
  const auto end = [&](std::string_view solver) {
    return run(problem, "newmark", {.t_end = 0.05, .h = 1e-3, .linear_solve = linear_solve_from(solver)}).y;
  };
  const VectorXd direct = end("direct");
  EXPECT_LT((end("cg") - direct).norm(), 1e-8 * direct.norm());
  EXPECT_LT((end("auto") - direct).norm(), 1e-8 * direct.norm());
}

TEST(TissueProblem, TakesTheMaterialsOfTheStudy) {
  const Problem problem = make_problem("fem_green@phantom", {.material = "liver:female_fat:heavy"});
  EXPECT_NEAR(problem.body->point_mass().sum(), problem.body->settings().total_mass.value(), 1e-12);
  EXPECT_EQ(problem.material, "liver:female_fat:heavy");
  // The oscillators' name means the same material, and what is set beside it counts.
  const Problem same =
      make_problem("fem_green@phantom", {.material = "female_fat:heavy", .parameters = {{"alpha", 0}}});
  EXPECT_EQ(same.body->settings().materials.front().young, problem.body->settings().materials.front().young);
  EXPECT_EQ(same.body->settings().alpha, 0);
  EXPECT_GT(problem.body->settings().alpha, 0);
}

TEST(TissueProblem, HoldsTheShareOfTheBodyThatIsAskedFor) {
  const auto dofs = [](double support, double axis) {
    return make_problem("fem_green@cube:n=4", {.parameters = {{"support", support}, {"axis", axis}}})
        .body->dofs();
  };
  EXPECT_EQ(dofs(0, 3), 3 * 125);
  EXPECT_EQ(dofs(0.1, 1), 3 * 100);
  EXPECT_EQ(dofs(0.3, 2), 3 * 75);
}

/// The rate of the fastest and of the slowest mode at rest.
std::pair<double, double> rates(const std::string& id,
                                std::vector<std::pair<std::string, double>> parameters) {
  parameters.emplace_back("g", 0);
  const Linearised near = linearised(make_problem(id, {.parameters = std::move(parameters)}));
  return {near.modes.spectrum.mechanical.front().kappa, near.modes.spectrum.mechanical.back().kappa};
}

TEST(TissueProblem, HasASkinFurtherSpringsAndOtherLawsOnDemand) {
  for (const char* id : {"fem_green@phantom", "mass_spring@phantom"}) {
    const auto [slow, fast] = rates(id, {});
    const auto [slow_skin, fast_skin] = rates(id, {{"skin", 1000}});
    EXPECT_GT(slow_skin, 1.2 * slow) << id;
    EXPECT_GT(fast_skin, 1.2 * fast) << id;
  }
  const auto [slow, fast] = rates("mass_spring@phantom", {});
  for (const char* set : {"bending", "second_ring", "doubled_skin"})
    EXPECT_GT(rates("mass_spring@phantom", {{set, 1}}).first, 1.01 * slow) << set;
  const double twice =
      rates("mass_spring@phantom", {{"k", 20}}).second / rates("mass_spring@phantom", {{"k", 10}}).second;
  EXPECT_NEAR(twice, 2, 1e-9);
  // A law shows when it is strained, not at rest.
  for (const auto& [law, strong] : {std::pair<const char*, double>{"cubic", 20}, {"exponential", 5}}) {
    EXPECT_NEAR(rates("mass_spring@phantom", {{law, strong}}).second, fast, 1e-9 * fast) << law;
    const auto stretch = [&, law = law](double b) {
      const Problem problem =
          make_problem("mass_spring/pull@phantom", {.parameters = {{"force", 2}, {law, b}}});
      const StaticSolution solution =
          solve_static(static_model(problem, 1), {.load_steps = 6}, [] { return 0.0; });
      EXPECT_TRUE(solution.converged) << law << " " << b << ": " << solution.note;
      return largest_displacement(solution.q);
    };
    EXPECT_LT(stretch(strong), 0.95 * stretch(0)) << law;
  }
}

TEST(TissueProblem, HoldsThePointsOfABox) {
  const auto dofs = [](std::vector<std::pair<std::string, double>> box) {
    return make_problem("fem_green@cube:n=4", {.parameters = std::move(box)}).body->dofs();
  };
  const TetMesh mesh = make_problem("fem_green@cube:n=4", {}).body->mesh();
  const double side = mesh.points.row(0).maxCoeff();
  EXPECT_EQ(dofs({{"support", 0}}), 3 * 125);
  // A face, an edge, a corner of 5 x 5 x 5 points.
  EXPECT_EQ(dofs({{"xmax", 0.1 * side}}), 3 * (125 - 25));
  EXPECT_EQ(dofs({{"xmax", 0.1 * side}, {"ymin", 0.9 * side}}), 3 * (125 - 5));
  EXPECT_EQ(dofs({{"xmax", 0.1 * side}, {"ymin", 0.9 * side}, {"zmax", 0.1 * side}}), 3 * (125 - 1));
  EXPECT_THROW(dofs({{"xmin", 2 * side}}), InputError);
}

TEST(TissueProblem, RefusesWhatItsModelMeshOrLoadDoesNotHave) {
  const auto refusal = [](const std::string& id, std::vector<std::pair<std::string, double>> parameters) {
    return error_of<InputError>([&] { make_problem(id, {.parameters = std::move(parameters)}); });
  };
  EXPECT_TRUE(says(refusal("fem_green@phantom", {{"cubic", 1}}), "mass_spring"));
  EXPECT_TRUE(says(refusal("mass_spring@phantom", {{"cubic", 1}, {"exponential", 1}}), "choose one"));
  EXPECT_TRUE(says(refusal("fem_green@phantom", {{"inclusion", 5}}), "regions"));
  for (const char* damping : {"alpha", "beta"})
    EXPECT_TRUE(says(refusal("fem_green@phantom", {{damping, -0.001}}), "negative"));
  EXPECT_TRUE(says(refusal("fem_green@phantom", {{"skin", -1}}), "negative"));
  EXPECT_TRUE(says(refusal("fem_green/breathing@phantom", {{"support", 0}}), "support"));
  EXPECT_TRUE(says(refusal("fem_green@phantom", {{"skin_thickness", 0}}), "positive"));
}

TEST(TissueProblem, TakesFibresOfTheBodyAndOfARegion) {
  const Scratch folder;
  const std::string file = (folder / "two.msh").string();
  write_text(file,
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
             "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"
             "$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 2 2 2 3 4 5\n$EndElements\n");
  const auto materials = [&](Parameters parameters) {
    parameters.emplace_back("support:points:1", 1);
    return make_problem("fem_green@" + file, {.parameters = std::move(parameters), .unit = 0.1})
        .body->settings()
        .materials;
  };
  const auto two = materials({{"fibre_E", 2e4}, {"fibre_x", 1}, {"fibre_E:2", 5e4}, {"fibre_z:2", -1}});
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].fibre_young, 2e4);
  EXPECT_EQ(two[1].fibre_young, 5e4);
  for (const TissueMaterial& each : two) EXPECT_EQ(each.fibre_x, 1);
  EXPECT_EQ(two[0].fibre_z, 0);
  EXPECT_EQ(two[1].fibre_z, -1);
  // What is listed of a body makes it again.
  const Problem problem =
      make_problem("fem_green@cube:n=1", {.parameters = {{"fibre_E", 2e4}, {"fibre_y", 3}}});
  const Problem again = make_problem(problem.id, {.parameters = problem.parameters});
  EXPECT_EQ(again.body->settings().materials[0].fibre_young, 2e4);
  EXPECT_EQ(again.body->settings().materials[0].fibre_y, 3);
  EXPECT_TRUE(says(in_words(summary_of(*problem.body)), "fibres of 2e+04 Pa"));
}

TEST(TissueProblem, RefusesFibresWithoutDirectionModulusOrElements) {
  const auto refusal = [](const std::string& id, Parameters parameters) {
    return error_of<std::exception>([&] { make_problem(id, {.parameters = std::move(parameters)}); });
  };
  EXPECT_TRUE(says(refusal("fem_green@cube:n=1", {{"fibre_E", 2e4}}), "give a vector like fibre_x=1"));
  EXPECT_TRUE(says(refusal("fem_green@cube:n=1", {{"fibre_E", -1}, {"fibre_x", 1}}), "negative"));
  EXPECT_TRUE(says(refusal("fem_green@cube:n=1", {{"fibre_x", 1}}), "give fibre_E"));
  EXPECT_TRUE(says(refusal("fem_green@cube:n=1", {{"fibre_z:1", 1}}), "give fibre_E"));
  for (const char* name : {"fibre_E", "fibre_E:1", "fibre_x"})
    EXPECT_TRUE(says(refusal("mass_spring@cube:n=1", {{name, 1}}), "is of finite elements")) << name;
  EXPECT_EQ(refusal("fem_green@cube:n=1", {{"fibre_E:0", 2e4}, {"fibre_z", 1}}), "");
}

TEST(TissueProblem, RefusesNumbersThatNothingReads) {
  const auto refusal = [](const std::string& id, const std::string& name, double value) {
    return error_of<InputError>([&] { make_problem(id, {.parameters = {{name, value}}}); });
  };
  EXPECT_TRUE(says(refusal("fem_green@phantom", "force", 2), "--load press"));
  EXPECT_TRUE(says(refusal("fem_green/press@phantom", "g", 1), "--load gravity"));
  EXPECT_TRUE(says(refusal("fem_green@phantom", "depth", 1), "--load tool"));
  EXPECT_TRUE(says(refusal("fem_green@phantom", "damper", 1), "mass_spring"));
  EXPECT_TRUE(says(refusal("fem_green@phantom", "skin_thickness", 1), "skin=1000"));
  EXPECT_TRUE(says(refusal("fem_green@phantom", "tool_radius", 0.01), "--load tool"));
  EXPECT_EQ(refusal("fem_green/pull@phantom", "force", 2), "");
  EXPECT_EQ(refusal("fem_green/breathing@phantom", "depth", 0.02), "");
  // What is listed of a body makes it again.
  EXPECT_EQ(refusal("fem_green@phantom", "force", 0.5), "");
}

TEST(TissueProblem, RefusesParametersThatChangeNothingBesideOthers) {
  const auto refusal = [](const std::string& id, std::vector<std::pair<std::string, double>> parameters,
                          std::string material = {}) {
    return error_of<InputError>(
        [&] { make_problem(id, {.material = std::move(material), .parameters = std::move(parameters)}); });
  };
  for (const char* nu : {"nu", "nu:1"})
    for (const double value : {0.3, 0.45})
      EXPECT_TRUE(says(refusal("mass_spring@phantom", {{nu, value}}), "Poisson's ratio of 1/4"));
  EXPECT_TRUE(says(refusal("fem_green@phantom", {{"rho", 900}, {"mass", 1}}), "mass=0"));
  EXPECT_TRUE(says(refusal("fem_green@phantom", {{"rho", 900}}, "male_slim"), "mass=0"));
  EXPECT_EQ(refusal("fem_green@phantom", {{"rho", 900}, {"mass", 0}}, "male_slim"), "");
  EXPECT_TRUE(says(refusal("mass_spring@phantom", {{"E", 8000}, {"k", 10}}), "k = 10"));
  EXPECT_EQ(refusal("mass_spring@phantom", {{"E", 8000}, {"k", 10}, {"skin", 1000}}), "");
  EXPECT_EQ(refusal("mass_spring/tool@phantom", {{"E", 8000}, {"k", 10}}), "");
  EXPECT_TRUE(says(refusal("fem_green@cube", {{"support", 0.3}, {"xmax", 0.01}}), "a box"));
  EXPECT_TRUE(says(refusal("fem_green@cube", {{"axis", 1}, {"xmax", 0.01}}), "axis does not act"));
  EXPECT_EQ(refusal("fem_green/press@cube", {{"axis", 1}, {"xmax", 0.01}}), "");
}

TEST(TissueProblem, DescribesTheParametersThatAct) {
  const auto acting = [](const std::string& id, ProblemSettings settings = {}) {
    return " " + describe_acting(make_problem(id, settings)) + " ";
  };
  const std::string springs = acting("mass_spring/press@phantom", {.material = "male_slim"});
  for (const char* idle : {" nu=", " rho=", " g=", " depth=", " equal_masses="})
    EXPECT_FALSE(says(springs, idle));
  for (const char* shown : {" E=", " mass=", " damper=", " force=", " support=", " axis="})
    EXPECT_TRUE(says(springs, shown));
  const std::string elements = acting("fem_green@phantom");
  EXPECT_TRUE(says(elements, " nu=0.45 rho=1060 "));
  EXPECT_FALSE(says(elements, "damper"));
  EXPECT_FALSE(says(acting("liver_linear"), "k3="));
  EXPECT_FALSE(says(acting("liver_cubic"), "w="));
  EXPECT_EQ(acting("liver_forced"), " m=1.45 c=2 k1=0.7 k3=0.8 P=0.5 w=0.5 ");
}

/// The settings of a body of the name `id`.
TissueSettings settings_with(const std::string& id, std::vector<std::pair<std::string, double>> parameters) {
  return make_problem(id, {.parameters = std::move(parameters)}).body->settings();
}

TEST(TissueProblem, GravityIsAVector) {
  const auto gravity = [](std::vector<std::pair<std::string, double>> parameters) {
    return settings_with("fem_green@phantom", std::move(parameters)).gravity;
  };
  EXPECT_EQ(gravity({}), Eigen::Vector3d(0, 0, -9.81));
  EXPECT_EQ(gravity({{"gy", -9.81}}), Eigen::Vector3d(0, -9.81, 0));
  EXPECT_EQ(gravity({{"gx", 1}, {"gy", 2}, {"gz", 3}}), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(gravity({{"gx", 0}, {"gy", 0}, {"gz", 0}}), Eigen::Vector3d::Zero());
  EXPECT_EQ(gravity({{"g", 2}, {"gx", 1}}), Eigen::Vector3d(1, 0, -2));
  EXPECT_THROW(settings_with("fem_green/press@phantom", {{"gy", -9.81}}), InputError);
}

TEST(TissueProblem, AToolStartsAndMovesWhereItIsTold) {
  const auto tool = [](std::vector<std::pair<std::string, double>> parameters) {
    parameters.insert(parameters.end(), {{"depth", 0.02}, {"tool_radius", 0.01}});
    return settings_with("fem_green/tool@cube:n=4,edge=0.1", std::move(parameters)).tools.at(0);
  };
  // The cube stands on z = 0, so the free end is its top.
  const Eigen::Vector3d middle(0.05, 0.05, 0.1);
  EXPECT_TRUE(tool({}).start.isApprox(middle + Eigen::Vector3d(0, 0, 0.01), 1e-12));
  EXPECT_TRUE(tool({}).travel.isApprox(Eigen::Vector3d(0, 0, -0.02), 1e-12));
  // A direction alone starts at the side that it comes from.
  const SphereTool sideways = tool({{"tool_dx", 2}});
  EXPECT_TRUE(sideways.start.isApprox(Eigen::Vector3d(-0.01, 0.05, 0.05), 1e-12)) << sideways.start;
  EXPECT_TRUE(sideways.travel.isApprox(Eigen::Vector3d(0.02, 0, 0), 1e-12));
  const SphereTool placed = tool({{"tool_x", 0}, {"tool_y", 0}, {"tool_z", 0.105}});
  EXPECT_TRUE(placed.start.isApprox(Eigen::Vector3d(0, 0, 0.115), 1e-12));
  EXPECT_TRUE(placed.travel.isApprox(Eigen::Vector3d(0, 0, -0.02), 1e-12));
  EXPECT_THROW(tool({{"tool_x", 0}, {"tool_y", 0}, {"tool_z", 0.2}}), InputError);
  EXPECT_THROW(tool({{"tool_x", 0}}), InputError);
  EXPECT_THROW(tool({{"tool_dx", 0}}), InputError);
  EXPECT_THROW(settings_with("fem_green@phantom", {{"tool_dx", 1}}), InputError);
}

TEST(TissueProblem, HasSpringsByTable) {
  const auto body = [](std::vector<std::pair<std::string, double>> parameters) {
    parameters.emplace_back("force", 0.3);
    return make_problem("mass_spring/press@phantom", {.parameters = parameters});
  };
  const auto energy = [&](std::vector<std::pair<std::string, double>> parameters) {
    const Problem problem = body(std::move(parameters));
    const auto& free = problem.body->free_points();
    VectorXd q(problem.body->dofs());
    for (std::size_t i = 0; i < free.size(); ++i)
      q.segment<3>(3 * static_cast<Eigen::Index>(i)) = 0.1 * problem.body->mesh().points.col(free[i]);
    return problem.body->energy(0, q);
  };
  // The line phi = s is the linear law; twice as steep has twice the elastic energy, of which loads have
  // none.
  const double linear = energy({}), loads = 2 * linear - energy({{"phi:-0.9", -1.8}, {"phi:1", 2}});
  EXPECT_NEAR(energy({{"phi:0.5", 0.5}}), linear, 1e-12 * std::abs(linear));
  EXPECT_NEAR(energy({{"phi:-0.5", -1.5}, {"phi:0.5", 1.5}}) - loads, 3 * (linear - loads),
              1e-9 * std::abs(linear));
  const Problem problem = body({{"phi:0.5", 0.75}});
  const auto& listed = problem.parameters;
  EXPECT_NE(std::ranges::find(listed, std::pair<std::string, double>("phi:0.5", 0.75)), listed.end());
  EXPECT_THROW(body({{"phi:0", 1}}), InputError);
  // Slack at rest, shortening by itself, no length left.
  EXPECT_THROW(body({{"phi:0.1", 0}}), InputError);
  EXPECT_THROW(body({{"phi:0.1", -0.1}}), InputError);
  EXPECT_THROW(body({{"phi:-1", -1}}), InputError);
  EXPECT_THROW(body({{"phi:0.5", 1}, {"phi:0.50", 2}}), InputError);
  EXPECT_THROW(body({{"phi:soft", 1}}), InputError);
  EXPECT_THROW(body({{"phi:0.5", 1}, {"cubic", 2}}), InputError);
  EXPECT_THROW(make_problem("fem_green@phantom", {.parameters = {{"phi:0.5", 1}}}), InputError);
}

TEST(TissueProblem, HasAMaterialForEachRegionOfItsFile) {
  const Scratch folder;
  // Two tetrahedra on a common face, regions 7 and 3 of the file.
  write_text(folder / "two.mesh",
             "MeshVersionFormatted 1\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n"
             "0 0 1 0\n1 1 1 0\nTetrahedra\n2\n1 2 3 4 7\n2 3 4 5 3\nEnd\n");
  const std::string id = "fem_green@" + (folder / "two.mesh").string();
  const auto materials = [&](std::vector<std::pair<std::string, double>> parameters) {
    return make_problem(id, {.parameters = std::move(parameters), .unit = 0.1}).body->settings().materials;
  };
  const auto made = materials({{"nu", 0.3}, {"E:7", 9000}, {"nu:3", 0.4}, {"rho:3", 900}});
  // Beside a mass a density would be a ratio.
  EXPECT_THROW(materials({{"mass", 1}, {"rho:3", 900}}), InputError);
  ASSERT_EQ(made.size(), 2u);  // region 3 first
  EXPECT_EQ(made[0].young, 5500);
  EXPECT_EQ(made[1].young, 9000);
  EXPECT_EQ(made[0].poisson, 0.4);
  EXPECT_EQ(made[1].poisson, 0.3);
  EXPECT_EQ(made[0].density, 900);
  EXPECT_EQ(made[1].density, 1060);
  EXPECT_TRUE(says(error_of<InputError>([&] { materials({{"E:4", 1}}); }), "no region 4; it has 3, 7"));
  EXPECT_THROW(materials({{"E:x", 1}}), InputError);
  EXPECT_THROW(materials({{"E:3", 8000}, {"E:3", 9000}}), InputError);
  EXPECT_EQ(materials({{"E:3", 8000}, {"E:7", 8000}, {"rho:3", 900}}).size(), 2u);
  EXPECT_THROW(materials({{"alpha:3", 1}}), InputError);
}

TEST(TissueProblem, SaysWhatIsWrongWithItsName) {
  const auto complaint = [](const std::string& id, ProblemSettings settings = {}) -> std::string {
    return error_of<InputError>([&] { make_problem(id, settings); });
  };
  EXPECT_TRUE(says(complaint("fem_gren@liver"), "fem_green"));
  EXPECT_TRUE(says(complaint("fem_green/prss@liver"), "press"));
  EXPECT_TRUE(says(complaint("fem_green@livre"), "liver"));
  EXPECT_TRUE(says(complaint("fem_green@cube", {.parameters = {{"nu", 0.5}}}), "0.5"));
  EXPECT_TRUE(says(complaint("fem_green@cube", {.parameters = {{"Nu", 0.4}}}), "nu"));
  EXPECT_TRUE(says(complaint("fem_green@cube", {.parameters = {{"equal_masses", 2}}}), "equal_masses"));
  EXPECT_TRUE(says(complaint("fem_green@cube", {.parameters = {{"support", 1}}}), "share"));
  EXPECT_TRUE(says(complaint("fem_green@cube", {.material = "male_fatt"}), "male_fat"));
  EXPECT_TRUE(says(complaint("fem_green@cube", {.y0 = {1}}), "--y0"));
}

TEST(TissueEquilibrium, IsWhereTheMotionComesToRest) {
  const Problem problem =
      make_problem("fem_green/press@cube:n=2",
                   {.parameters = {{"E", 4000}, {"force", 0.3}, {"alpha", 20}, {"beta", 0.02}}});
  const StaticSolution rest = solve_static(static_model(problem, 1), {}, [] { return 0.0; });
  ASSERT_TRUE(rest.converged) << rest.note;
  const VectorXd late = run(problem, "implicit_euler", {.t_end = 20, .h = 0.05}).y;
  EXPECT_LT((late.head(rest.q.size()) - rest.q).norm(), 1e-6 * rest.q.norm());
  // Twice the load moves a stiffening body less than twice as far, and not at all alike.
  const StaticSolution twice = solve_static(static_model(problem, 2), {}, [] { return 0.0; });
  ASSERT_TRUE(twice.converged) << twice.note;
  EXPECT_GT((twice.q - 2 * rest.q).norm(), 1e-3 * rest.q.norm());
}

}  // namespace
}  // namespace hmax
