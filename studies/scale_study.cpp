#include "studies/scale_study.hpp"

#include <cmath>

#include <fmt/format.h>

#include "analysis/spectrum/block_product.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/device/device_run.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/process/peak_memory.hpp"
#include "core/size_limits.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/tissue/body.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

using Task = std::function<void(std::int64_t)>;

/// A mesh as a file, as long as this lives.
class MeshOnDisk {
 public:
  MeshOnDisk(const std::string& mesh, const std::filesystem::path& folder)
      : file_(folder / "scale_study.msh") {
    write_file(file_, msh_text(open_mesh(mesh).file.mesh));
  }
  ~MeshOnDisk() {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }
  MeshOnDisk(const MeshOnDisk&) = delete;
  MeshOnDisk& operator=(const MeshOnDisk&) = delete;

  [[nodiscard]] std::string name() const { return file_.string(); }

 private:
  std::filesystem::path file_;
};

LanczosPair fastest(const TissueBody& body, const TissueBody::DofMatrix& K) {
  const SymmetricProduct A(K, body.mass().cwiseSqrt().cwiseInverse());
  return largest_eigenpair([&](const Eigen::VectorXd& x, Eigen::VectorXd& y) { A(x, y); }, body.dofs(),
                           {.with_vector = false});
}

/// A step of symplectic Euler on a device [s].
double step_on(const std::shared_ptr<Device>& device, const Problem& problem, double h,
               const std::function<bool()>& keep_going) {
  constexpr int steps = 100;  // that one start of the programs is shared by
  const Runner runner = on_device(find_method("symplectic_euler"), device).bind(problem);
  const Task task = [&](std::int64_t runs) { runner.repeat({.t_end = steps * h, .h = h}, runs); };
  return time_interleaved(
             {&task, 1},
             {.repetitions = 5, .min_sample_s = 5e-3, .clock = runner.seconds, .keep_going = keep_going})
             .front()
             .least() /
         steps;
}

ScaleRow measured(const std::string& mesh, const std::filesystem::path& folder,
                  const std::function<bool()>& keep_going, const std::shared_ptr<Device>& device) {
  const MeshOnDisk file(mesh, folder);
  const Problem problem = make_problem(tissue_id("fem_green", file.name(), "gravity"), {.unit = 1});
  const TissueBody& body = *problem.body;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.dofs());
  Eigen::VectorXd f = zero;
  TissueBody::DofMatrix K;
  body.stiffness(0, zero, zero, K);
  ScaleRow row{.mesh = mesh,
               .tetrahedra = body.mesh().tetrahedron_count(),
               .points = body.mesh().point_count(),
               .dofs = body.dofs()};
  row.omega = std::sqrt(fastest(body, K).value);

  const Runner explicit_runner = find_method("symplectic_euler").bind(problem),
               implicit_runner = find_method("linearly_implicit_euler").bind(problem);
  constexpr int explicit_steps = 10, implicit_steps = 2;
  const double short_step = 1 / row.omega;
  RunSpec implicit_run{.t_end = implicit_steps * 0.01, .h = 0.01};
  implicit_run.linear_solve = {.by = LinearSolve::By::conjugate_gradients, .tolerance = 1e-6};
  struct Timed {
    double ScaleRow::*into;
    int runs;  // that one call of the task is made of
    Task task;
  };
  const std::vector<Timed> timed{
      {&ScaleRow::force, 1, repeated([&] { body.force(0, zero, zero, f); })},
      {&ScaleRow::stiffness, 1, repeated([&] { body.stiffness(0, zero, zero, K); })},
      {&ScaleRow::explicit_step, explicit_steps,
       [&](std::int64_t runs) {
         explicit_runner.repeat({.t_end = explicit_steps * short_step, .h = short_step}, runs);
       }},
      {&ScaleRow::implicit_step, implicit_steps,
       [&](std::int64_t runs) { implicit_runner.repeat(implicit_run, runs); }},
      {&ScaleRow::eigenvalue, 1, repeated([&] { fastest(body, K); })},
      {&ScaleRow::import, 1, repeated([&] { load_mesh(file.name(), 1.0); })},
  };
  std::vector<Task> tasks;
  for (const Timed& each : timed) tasks.push_back(each.task);
  const std::vector<Timing> timings =
      time_interleaved(tasks, {.repetitions = row.tetrahedra < least_timed_twice ? 5 : 2,
                               .min_sample_s = 5e-3,
                               .keep_going = keep_going});
  for (std::size_t i = 0; i < timings.size(); ++i) row.*timed[i].into = timings[i].least() / timed[i].runs;
  if (device) row.device_step = step_on(device, problem, short_step, keep_going);
  row.peak_memory = static_cast<double>(peak_memory().value_or(0));
  return row;
}

}  // namespace

std::vector<std::string> scale_meshes() {
  std::vector<std::string> meshes;
  for (const int n : {4, 7, 12, 18, 27, 37}) meshes.push_back(fmt::format("ball:n={}", n));
  return meshes;
}

std::vector<ScaleRow> scale_study(std::span<const std::string> meshes, const std::filesystem::path& folder,
                                  const std::function<void(double, const std::string&)>& progress,
                                  const std::shared_ptr<Device>& device) {
  std::vector<ScaleRow> rows;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const auto tell = [&] {
      progress(static_cast<double>(i) / static_cast<double>(meshes.size()), meshes[i]);
      return true;
    };
    tell();
    rows.push_back(measured(meshes[i], folder, tell, device));
  }
  return rows;
}

}  // namespace hmax
