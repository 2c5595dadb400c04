#include "studies/organ_rates.hpp"

#include "advice/candidate.hpp"
#include "advice/motion_run.hpp"
#include "advice/probing_motion.hpp"
#include "analysis/statics/static_solution.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/parallel_for.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

constexpr double thesis_frame = 0.01;  // [s]

Problem pressed(std::string_view model, std::string_view mesh, std::string_view material) {
  return make_problem(tissue_id(model, mesh, "press"),
                      {.material = std::string(material), .parameters = {{"force", 0.2}}, .y0 = {}});
}

}  // namespace

std::vector<ConstantJacobian> constant_jacobians(const std::vector<std::string>& meshes,
                                                 std::string_view material) {
  std::vector<ConstantJacobian> all;
  for (const std::string& mesh : meshes)
    for (const std::string_view model : {"mass_spring", "fem_green"}) {
      const ProbingMotion motion = probing_motion(pressed(model, mesh, material));
      const ReferenceMotion reference = reference_motion(motion, thesis_frame, 0.01);
      const Candidate candidate{.method = find_method("linearly_implicit_euler"),
                                .jacobian = jacobian_update_from("frozen"),
                                .linear_solve = linear_solve_from("direct")};
      const MotionRun run = run_motion(candidate, motion, reference, thesis_frame, 1, {.frames = 300});
      const FrameTimes times = frame_times(run.frames_s);
      const TetMesh& tetrahedra = motion.problem.body->mesh();
      all.push_back({mesh, std::string(model), static_cast<long>(tetrahedra.tetrahedron_count()),
                     static_cast<long>(edges_of(tetrahedra).cols()), run.reached_end(), run.error, times.p50,
                     times.p99, 1 / times.p50});
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
