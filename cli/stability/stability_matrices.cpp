/// hmax stability matrices
#include <filesystem>
#include <memory>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/limits/linearised_problem.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/operating_point.hpp"
#include "cli/stability/stability.hpp"
#include "problems/matrices/matrix_writers.hpp"
#include "results/errors.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;
using Sparse = Eigen::SparseMatrix<double>;

struct MatricesOptions {
  ProblemChoice problem;
  OperatingPointChoice at;
  std::string output;
};

/// A file of the answer.
struct Written {
  std::string key;  ///< of --matrices
  std::string file;
  Sparse matrix;
};

Sparse sparse(const AnyMatrix& matrix) {
  return is_sparse(matrix) ? std::get<Sparse>(matrix) : Sparse(std::get<Eigen::MatrixXd>(matrix).sparseView());
}

std::vector<Written> matrices_of(const LinearModel& model) {
  if (!model.mechanical) return {{"jacobian", {}, sparse(model.J())}};
  const MechanicalPart& part = *model.mechanical;
  std::vector<Written> files{{"stiffness", {}, sparse(part.K)}, {"mass", {}, Sparse(part.mass.asDiagonal())}};
  if (part.damping != Damping::none) files.push_back({"damping", {}, sparse(part.C)});
  return files;
}

void write(const MatricesOptions& options, const Problem& problem, std::vector<Written>& files) {
  const std::filesystem::path folder = options.output;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder, error))
    throw InputError(fmt::format("--output {} is no folder and cannot be made one; name another", options.output));
  for (Written& each : files) {
    each.file = (folder / (each.key + ".mtx")).string();
    write_file(each.file, matrix_market_text(each.matrix, fmt::format("{} of {}", each.key, problem.id)));
  }
}

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
  std::vector<Written> files = matrices_of(point.model);
  write(options, problem, files);
  std::string option;
  Json document{{"problem", problem.id},
                {"state_kind", name_of(point.kind)},
                {"status", point.status.empty() ? Json() : Json(point.status)},
                {"unknowns", files.front().matrix.rows()}};
  std::string text = fmt::format("{}: {}\n", problem.id, point.state);
  for (const Written& each : files) {
    document[each.key] = each.file;
    option += fmt::format("{}{}={}", option.empty() ? "" : ",", each.key, each.file);
    text += fmt::format("{}: {} x {}, {} entries\n", each.file, each.matrix.rows(), each.matrix.cols(),
                        each.matrix.nonZeros());
  }
  document["matrices"] = option;
  if (console.json) return console.print_json(document);
  console.print(text + fmt::format("use them with --matrices {}\n", option));
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
  command
      .add_option("--output", options->output,
                  "Folder of stiffness.mtx, mass.mtx and damping.mtx, or of jacobian.mtx of a first-order model; it is "
                  "made if needed")
      ->type_name("FOLDER");
  add_force(command);
  command.callback([options, &console] { matrices(*options, console); });
}

}  // namespace hmax
