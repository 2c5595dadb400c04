#include "studies/organ_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "bench/timing/timing.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/parallel_for.hpp"
#include "integrators/linear/sparse_solver.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

constexpr std::array<std::string_view, 5> models{"fem_cauchy", "fem_green", "fem_corotational",
                                                 "fem_neo_hookean", "mass_spring"};
constexpr double study_modulus = 5500;  // [Pa]

double volume_of(const TetMesh& mesh, const Eigen::Matrix3Xd& points, double* spread = nullptr) {
  double sum = 0;
  for (Eigen::Index i = 0; i < mesh.tetrahedron_count(); ++i) {
    Corners now;
    for (int k = 0; k < 4; ++k) now.col(k) = points.col(mesh.tetrahedra(k, i));
    const double volume = signed_volume(now), rest = signed_volume(corners_of(mesh, i));
    sum += volume;
    if (spread) *spread = std::max(*spread, std::abs(volume / rest - 1));
  }
  return sum;
}

/// Positions of all points turned about the x axis through the middle, as displacements of the free ones.
Eigen::VectorXd turned(const TissueBody& body, double angle) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Matrix3Xd& X = body.mesh().points;
  const Eigen::Vector3d centre = X.rowwise().mean();
  Eigen::VectorXd q(body.dofs());
  Eigen::Index dof = 0;
  for (const TetMesh::Index point : body.free_points()) {
    const Eigen::Vector3d from = X.col(point) - centre;
    q.segment<3>(dof) = R * from - from;
    dof += 3;
  }
  return q;
}

Problem body_of(std::string_view model, std::string_view mesh, const char* load, Parameters parameters) {
  parameters.emplace_back("E", study_modulus);
  return make_problem(tissue_id(model, mesh, load), {.parameters = std::move(parameters)});
}

PressedVolume measured(const Problem& problem, const Eigen::VectorXd& q) {
  const TissueBody& body = *problem.body;
  PressedVolume result;
  const Eigen::Matrix3Xd points = body.positions(equilibrium_time(body), q);
  result.displacement = largest_displacement(q);
  result.lost =
      1 - volume_of(body.mesh(), points, &result.spread) / volume_of(body.mesh(), body.mesh().points);
  return result;
}

/// The equilibrium under the share of the load whose largest displacement is the wanted one, by bisection.
Eigen::VectorXd pressed_to(const Problem& problem, double displacement) {
  const auto solved = [&](double share) {
    return solve_static(static_model(problem, share), {.load_steps = 4}, thread_cpu_seconds);
  };
  double low = 0, high = 1;
  Eigen::VectorXd q;
  for (int i = 0; i < 30; ++i) {
    const double share = std::sqrt(std::max(low, 1e-3 * high) * high);
    const StaticSolution solution = solved(share);
    const bool enough = !solution.converged || largest_displacement(solution.q) >= displacement;
    (enough ? high : low) = share;
    if (solution.converged) q = solution.q;
    if (solution.converged && std::abs(largest_displacement(solution.q) / displacement - 1) < 1e-4) break;
  }
  return q;
}

}  // namespace

std::vector<TurnedBody> turned_bodies(std::string_view mesh) {
  std::vector<TurnedBody> all;
  for (const std::string_view model : models) {
    Parameters parameters{{"support", 0}, {"g", 0}};
    if (model != "mass_spring") parameters.emplace_back("nu", 0.3);
    const Problem problem = body_of(model, mesh, "gravity", std::move(parameters));
    const TissueBody& body = *problem.body;
    TurnedBody& turning = all.emplace_back(TurnedBody{std::string(model), {}, {}});
    const double scale = study_modulus * volume_of(body.mesh(), body.mesh().points);
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(body.dofs());
    for (int angle = 0; angle <= 90; angle += 5) {
      turning.angle.push_back(angle);
      const Eigen::VectorXd q = turned(body, angle * std::numbers::pi / 180);
      turning.energy.push_back((body.energy(0, q) - body.energy(0, rest)) / scale);
    }
  }
  return all;
}

std::vector<PressedVolume> pressed_volumes(std::string_view mesh, double displacement) {
  std::vector<PressedVolume> all;
  const auto add = [&](std::string_view model, double nu, Parameters parameters) {
    parameters.emplace_back("force", 2);
    const Problem problem = body_of(model, mesh, "press", std::move(parameters));
    all.push_back(measured(problem, pressed_to(problem, displacement)));
    all.back().model = model;
    all.back().nu = nu;
  };
  add("mass_spring", 0.25, {});
  for (const double nu : {0.3, 0.45, 0.49}) add("fem_green", nu, {{"nu", nu}});
  return all;
}

std::vector<InnerTolerance> inner_tolerances(const StaticModel& model, double relaxation) {
  const OneThread alone;  // its CPU time is reported, as below
  std::vector<InnerTolerance> all;
  for (const StaticMethod method : {StaticMethod::modified_newton, StaticMethod::newton})
    for (const double tolerance : {0.5, 0.1, 1e-2, 1e-4, 1e-8}) {
      StaticSettings settings{.method = method, .inner = InnerSolver::sor, .iterations = 2000};
      settings.inner_tolerance = tolerance;
      settings.inner_iterations = 20000;
      settings.relaxation = relaxation;
      const StaticSolution solution = solve_static(model, settings, thread_cpu_seconds);
      const StaticIterate& last = solution.history.back();
      all.push_back({method, tolerance, solution.converged, solution.iterations, last.inner, last.seconds});
    }
  return all;
}

AccurateSolution accurate_solution(const std::vector<InnerTolerance>& rows) {
  std::vector<InnerTolerance> newton;
  std::ranges::copy_if(rows, std::back_inserter(newton),
                       [](const InnerTolerance& row) { return row.method == StaticMethod::newton; });
  Eigen::MatrixXd A(newton.size(), 2);
  Eigen::VectorXd seconds(newton.size());
  const InnerTolerance *loose = nullptr, *tight = nullptr;
  for (std::size_t i = 0; i < newton.size(); ++i) {
    const InnerTolerance& row = newton[i];
    A.row(static_cast<Eigen::Index>(i)) << row.iterations, static_cast<double>(row.sweeps);
    seconds[static_cast<Eigen::Index>(i)] = row.seconds;
    if (row.tolerance == 0.1) loose = &row;
    if (row.tolerance == 1e-4) tight = &row;
  }
  const Eigen::Vector2d cost = A.colPivHouseholderQr().solve(seconds);
  return {
      .iteration = std::max(0.0, cost[0]) / cost[1],
      .needed = static_cast<double>(tight->sweeps - loose->sweeps) / (loose->iterations - tight->iterations)};
}

std::vector<LoadedIterations> loaded_iterations(std::string_view mesh, std::string_view material,
                                                const std::vector<double>& forces) {
  std::vector<LoadedIterations> all;
  for (const double force : forces) {
    const StaticModel model =
        static_model(make_problem(tissue_id("fem_green", mesh, "press"),
                                  {.material = std::string(material), .parameters = {{"force", force}}}),
                     1);
    const auto iterations = [&](StaticMethod method) {
      const StaticSolution solution =
          solve_static(model, {.method = method, .iterations = 2000}, thread_cpu_seconds);
      return solution.converged ? solution.iterations : 0;
    };
    all.push_back({force, iterations(StaticMethod::newton), iterations(StaticMethod::modified_newton)});
  }
  return all;
}

LinearSolutions linear_solutions(const StaticModel& model) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.dofs);
  Eigen::VectorXd f = zero, u = zero;
  StaticModel::Matrix K;
  model.force(zero, f);
  model.stiffness(zero, K);
  Eigen::MatrixXd inverse;
  SparseSolver<double> solver;
  solver.set({.by = LinearSolve::By::direct});
  const std::vector<std::function<void(std::int64_t)>> tasks{
      repeated([&] {
        inverse = Eigen::MatrixXd(K).llt().solve(Eigen::MatrixXd::Identity(model.dofs, model.dofs));
      }),
      repeated([&] { solver.factor(K); }), repeated([&] { u.noalias() = inverse * f; }), repeated([&] {
        u = f;
        solver.solve(u);
      })};
  const std::vector<Timing> timings = time_interleaved(tasks, {.repetitions = 5});
  return {.dofs = model.dofs,
          .invert = timings[0].least(),
          .factor = timings[1].least(),
          .multiply = timings[2].least(),
          .solve = timings[3].least(),
          .inverse_bytes = static_cast<double>(sizeof(double)) * static_cast<double>(model.dofs) *
                           static_cast<double>(model.dofs)};
}

std::vector<FrameBudget> frame_budgets(const StaticModel& model, int frames) {
  const OneThread alone;
  std::vector<FrameBudget> all;
  for (const int iterations : {1, 2, 4}) {
    const std::vector<StaticFrame> run = pseudo_dynamic(model, {}, frames, iterations, thread_cpu_seconds);
    FrameBudget& budget = all.emplace_back(FrameBudget{.iterations = iterations});
    std::vector<double> seconds;
    for (const StaticFrame& frame : run) {
      seconds.push_back(frame.seconds);
      budget.error = std::max(budget.error, frame.error);
    }
    if (run.size() < static_cast<std::size_t>(frames))
      budget.error = std::numeric_limits<double>::quiet_NaN();
    std::ranges::sort(seconds);
    budget.seconds = seconds.empty() ? 0 : seconds[seconds.size() / 2];
  }
  return all;
}

}  // namespace hmax
