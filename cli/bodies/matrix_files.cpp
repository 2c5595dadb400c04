#include "cli/bodies/matrix_files.hpp"

#include <filesystem>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "core/text/sentences.hpp"
#include "problems/matrices/matrix_writers.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/tissue/body.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// A file of the answer.
struct Written {
  std::string key;  ///< of --matrices
  std::string file;
  Sparse matrix;
};

Sparse sparse(const AnyMatrix& matrix) {
  return is_sparse(matrix) ? std::get<Sparse>(matrix)
                           : Sparse(std::get<Eigen::MatrixXd>(matrix).sparseView());
}

std::vector<Written> matrices_of(const LinearModel& model) {
  if (!model.mechanical) return {{"jacobian", {}, sparse(model.J())}};
  const MechanicalPart& part = *model.mechanical;
  std::vector<Written> files{{"stiffness", {}, sparse(part.K)}, {"mass", {}, part.mass.matrix()}};
  if (part.damping != Damping::none) files.push_back({"damping", {}, sparse(part.C)});
  return files;
}

void write_files(const std::string& name, const std::string& problem, std::vector<Written>& files) {
  const std::filesystem::path folder = name;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder, error))
    throw InputError(fmt::format("'{}' is not a folder and cannot be made one; name another", name));
  for (Written& each : files) {
    each.file = (folder / (each.key + ".mtx")).string();
    write_file(each.file, matrix_market_text(each.matrix, fmt::format("{} of {}", each.key, problem)));
  }
}

/// "12.3", a line for each unknown.
std::string names_of_unknowns(const TissueBody& body) {
  std::string names = fmt::format("# direction 3 of point 12 is 12.3, {}\n", own_mark);
  const MeshOrigin* const origin = body.origin().get();
  for (const TetMesh::Index point : body.free_points()) {
    const auto place =
        static_cast<std::size_t>(origin ? origin->points[static_cast<std::size_t>(point)] : point);
    const bool numbered = origin && place < origin->file.point_numbers.size();
    const auto number = numbered ? origin->file.point_numbers[place] : static_cast<std::int64_t>(place) + 1;
    for (int direction = 1; direction <= 3; ++direction) names += fmt::format("{}.{}\n", number, direction);
  }
  return names;
}

}  // namespace

void write_matrices(const Problem& problem, const OperatingPoint& point, const std::string& folder,
                    Console& console) {
  std::vector<Written> files = matrices_of(point.model);
  write_files(folder, point.problem, files);
  if (problem.body)
    write_file(std::filesystem::path(folder) / "stiffness.dof", names_of_unknowns(*problem.body));
  const std::string kink(
      point.at_kink
          ? "the slopes of the model jump at this state: the matrices are those of its stiffest side"
          : "");
  std::string option;
  Json document{{"problem", point.problem},
                {"state_kind", name_of(point.kind)},
                {"status", json_or_null(joined(point.status, kink))},
                {"unknowns", files.front().matrix.rows()}};
  std::string text = fmt::format("{}: {}\n", point.problem, point.state);
  for (const Written& each : files) {
    document[each.key] = each.file;
    option += fmt::format("{}{}={}", option.empty() ? "" : ",", each.key, each.file);
    text += fmt::format("{}: {} x {}, {} entries\n", each.file, each.matrix.rows(), each.matrix.cols(),
                        each.matrix.nonZeros());
  }
  document["matrices"] = option;
  if (point.at_kink) text += kink + "\n";
  // The matrices are not those that were asked for, as the limits of `hmax stability predict`.
  if (point.kind == StateKind::rest && !point.status.empty()) console.exit_code = Exit::failed;
  console.show(document, text + fmt::format("use them with --matrices {}\n", option));
}

}  // namespace hmax
