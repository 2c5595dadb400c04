/// hmax stability matrices
#include <memory>

#include "cli/bodies/matrix_files.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/operating_point.hpp"
#include "cli/stability/stability.hpp"
#include "core/errors.hpp"
#include "limits/linearised_problem.hpp"

namespace hmax {

namespace {

struct MatricesOptions {
  ProblemChoice problem;
  OperatingPointChoice at;
  std::string output;
};

void matrices(const MatricesOptions& options, Console& console) {
  if (options.output.empty()) throw InputError("no folder is given; add --output FOLDER");
  const Problem problem = options.problem.make();
  options.problem.remark_idle(console, problem);
  const AskedState at = options.at.of(problem);
  announce_equilibrium(console, problem, at);
  const OperatingPoint point = [&] {
    Progress progress(console, "matrices");
    LinearisationProgress shown(progress);
    return operating_point(problem, at, shown.watcher());
  }();
  write_matrices(problem, point, options.output, console);
}

}  // namespace

void add_stability_matrices(CLI::App& stability, Console& console) {
  CLI::App& command = add_command(
      stability, console, "matrices", "Write stiffness, mass and damping of a model as Matrix Market files",
      {"hmax stability matrices --mesh phantom --material liver:male_normal --at rest --output phantom",
       "hmax stability matrices --problem spring_chain --output chain --json"});
  const auto options = std::make_shared<MatricesOptions>();
  options->problem.add_to(command);
  options->at.add_to(command);
  add_text(
      command, "--output", options->output,
      "Folder of stiffness.mtx, mass.mtx and damping.mtx, or of jacobian.mtx of a first-order model; it is "
      "made if needed; of a body stiffness.dof names the unknowns",
      "FOLDER");
  add_force(command);
  add_jobs(command);
  set_callback(command, [options, &console] { matrices(*options, console); });
}

}  // namespace hmax
