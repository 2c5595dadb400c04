#include "studies/organ_rates.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "advice/motion/candidate.hpp"
#include "advice/motion/motion_run.hpp"
#include "advice/motion/probing_motion.hpp"
#include "analysis/statics/static_solution.hpp"
#include "bench/micro/plain_tissue.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/parallel_for.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/spring_sets.hpp"

namespace hmax {

namespace {

Problem pressed(std::string_view model, std::string_view mesh, std::string_view material,
                Parameters more = {}) {
  more.emplace_back("force", 0.2);
  return make_problem(tissue_id(model, mesh, "press"),
                      {.material = std::string(material), .parameters = std::move(more)});
}

/// @param springs  that the problem has, or edges of its mesh
ConstantJacobian run_of(const Problem& problem, std::string mesh, std::string model, long springs, double h) {
  const ProbingMotion motion = probing_motion(problem);
  const ReferenceMotion reference = reference_motion(motion, h, 0.01);
  const Candidate candidate{.method = find_method("linearly_implicit_euler"),
                            .jacobian = jacobian_update_from("frozen"),
                            .linear_solve = linear_solve_from("direct")};
  const MotionRun run = run_motion(candidate, motion, reference, h, 1, {.frames = 300});
  const FrameTimes times = frame_times(run.frames_s);
  return {.mesh = std::move(mesh),
          .model = std::move(model),
          .tetrahedra = static_cast<long>(motion.problem.body->mesh().tetrahedron_count()),
          .springs = springs,
          .asked = 1 / h,
          .reached_end = run.reached_end(),
          .error = run.error,
          .p50 = times.p50,
          .p99 = times.p99,
          .rate = 1 / times.p50};
}

/// The forces of a body at rest by plain loops over all its points.
std::function<void(std::int64_t)> plain_forces(const TissueBody& body) {
  const TetMesh& mesh = body.mesh();
  const TissueMaterial& material = body.settings().materials.front();
  const auto of = [&mesh](auto forces) {
    return repeated([forces = std::move(forces), x = mesh.points, f = mesh.points]() mutable {
      f.setZero();
      forces.force(x.data(), f.data());
    });
  };
  if (!body.settings().model.is_of_springs())
    return of(plain::Green(mesh, lame(material.young, material.poisson)));
  plain::Springs springs;
  for (const SpringSet::Spring& spring :
       tissue_springs(mesh, edge_table(mesh), surface_of(mesh), body.settings())) {
    const auto [a, b] = spring.points;
    springs.springs.push_back({a, b, (mesh.points.col(a) - mesh.points.col(b)).norm(), spring.stiffness});
  }
  return of(std::move(springs));
}

}  // namespace

std::vector<ConstantJacobian> constant_jacobians(const std::vector<std::string>& meshes,
                                                 std::string_view material) {
  std::vector<ConstantJacobian> all;
  for (const std::string& mesh : meshes) {
    for (const char* model : {"mass_spring", "fem_green"}) {
      const Problem problem = pressed(model, mesh, material);
      const auto edges = static_cast<long>(edges_of(problem.body->mesh()).cols());
      all.push_back(run_of(problem, mesh, model, edges, 0.01));
    }
    const Problem problem = pressed("mass_spring", mesh, material, {{"second_ring", 1}, {"bending", 1}});
    const TissueBody& body = *problem.body;
    const auto springs =
        tissue_springs(body.mesh(), edge_table(body.mesh()), surface_of(body.mesh()), body.settings());
    all.push_back(
        run_of(problem, mesh, "mass_spring, further springs", static_cast<long>(springs.size()), 1.0 / 150));
  }
  return all;
}

std::vector<ModelCost> model_costs(const std::vector<std::string>& meshes, std::string_view material) {
  constexpr double h = 0.01;
  constexpr int steps = 20;
  std::vector<ModelCost> all;
  std::vector<std::function<void(std::int64_t)>> tasks;
  for (const std::string& mesh : meshes)
    for (const char* model : {"mass_spring", "fem_green"}) {
      all.push_back({.mesh = mesh, .model = model});
      const Problem problem =
          make_problem(tissue_id(model, mesh, "gravity"), {.material = std::string(material)});
      const Eigen::VectorXd zero = Eigen::VectorXd::Zero(problem.body->dofs());
      tasks.push_back(
          repeated([body = problem.body, zero, f = zero]() mutable { body->force(0, zero, zero, f); }));
      tasks.push_back(plain_forces(*problem.body));
      tasks.emplace_back([runner = find_method("linearly_implicit_euler").bind(problem)](std::int64_t runs) {
        runner.repeat({.t_end = steps * h, .h = h}, runs);
      });
    }
  const std::vector<Timing> timings = time_interleaved(tasks, {.repetitions = 7});
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].force = timings[3 * i].least();
    all[i].plain = timings[3 * i + 1].least();
    all[i].step = timings[3 * i + 2].least() / steps;
  }
  return all;
}

double newton_rate(std::string_view mesh, std::string_view material) {
  const OneThread alone;  // its CPU time is reported
  const StaticModel model = static_model(pressed("fem_green", mesh, material), 1);
  int iterations = 0;
  const double start = thread_cpu_seconds();
  double seconds = 0;
  while (seconds < 0.05) {
    iterations += solve_static(model, {}, thread_cpu_seconds).iterations;
    seconds = thread_cpu_seconds() - start;
    if (iterations == 0) return 0;
  }
  return iterations / seconds;
}

}  // namespace hmax
