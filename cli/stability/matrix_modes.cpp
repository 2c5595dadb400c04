#include "cli/stability/matrix_modes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "core/errors.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

struct MatrixMode {
  double kappa, omega, zeta;
  double moving;         ///< 1 over the sum of squares of the unknowns' shares of kinetic energy
  Eigen::Index unknown;  ///< with the largest share
  double share;

  [[nodiscard]] double frequency() const { return omega / (2 * std::numbers::pi); }
};

std::vector<MatrixMode> modes_of(const MechanicalPart& part, const ExtremeStiffnesses& found) {
  std::vector<MatrixMode> modes;
  for (std::size_t i = 0; i < found.kappa.size(); ++i) {
    const Eigen::VectorXd u = found.shapes.col(static_cast<Eigen::Index>(i));
    const Eigen::VectorXd Cu = std::visit([&](const auto& C) -> Eigen::VectorXd { return C * u; }, part.C);
    const Eigen::VectorXd shares = u.cwiseProduct(part.mass.times(u));
    MatrixMode mode{.kappa = found.kappa[i],
                    .omega = std::sqrt(std::max(found.kappa[i], 0.0)),
                    .zeta = 0,
                    .moving = 1 / shares.squaredNorm(),
                    .unknown = 0,
                    .share = 0};
    if (mode.omega > 0) mode.zeta = 0.0 + u.dot(Cu) / (2 * mode.omega);  // no -0
    mode.share = shares.maxCoeff(&mode.unknown);
    modes.push_back(mode);
  }
  return modes;
}

}  // namespace

void print_matrix_modes(const Problem& problem, const OperatingPoint& point, Eigen::Index count, bool fastest,
                        Console& console) {
  if (!point.model.mechanical)
    throw InputError("a first-order model has no modes of free motion; give stiffness and mass");
  const MechanicalPart& part = *point.model.mechanical;
  if (!part.symmetric)
    throw InputError(
        "stiffness and damping are not both symmetric, so there are no modes of free motion; `hmax stability "
        "predict` takes such matrices");
  count = std::min(count, part.mass.size());
  const ExtremeStiffnesses found =
      fastest ? largest_stiffnesses(part, count) : smallest_stiffnesses(part, count);
  if (!found.converged)
    throw InputError(
        fmt::format("the modes of {} unknowns did not converge; ask for fewer", part.mass.size()));
  const std::vector<MatrixMode> modes = modes_of(part, found);
  const MatrixModel* model = problem.matrices.get();
  const auto row_of = [&](const MatrixMode& mode) {
    return model->unknowns[static_cast<std::size_t>(mode.unknown)];
  };
  if (console.json) {
    Json list = Json::array();
    for (const MatrixMode& mode : modes)
      list.push_back({{"kappa", mode.kappa},
                      {"omega", mode.omega},
                      {"frequency", mode.frequency()},
                      {"zeta", mode.zeta},
                      {"moving_unknowns", mode.moving},
                      {"unknown", row_of(mode) + 1},
                      {"unknown_share", mode.share}});
    return console.print_json({{"problem", problem.id},
                               {"dofs", part.mass.size()},
                               {"state_kind", name_of(point.kind)},
                               {"end", fastest ? "fastest" : "slowest"},
                               {"modes", list}});
  }
  TextTable table(
      {"mode", "frequency [Hz]", "omega [rad/s]", "zeta", "moving unknowns", "largest share of the energy"});
  for (std::size_t i = 0; i < modes.size(); ++i)
    table.add({std::to_string(i + 1), short_number(modes[i].frequency()), short_number(modes[i].omega),
               short_number(modes[i].zeta, 4), short_number(modes[i].moving, 3),
               fmt::format("{} with {} %", model->name_of(row_of(modes[i])),
                           short_number(100 * modes[i].share, 3))});
  console.print(fmt::format("{}\n{}\n\n{}", problem.id, problem.note, table.text(console)));
}

}  // namespace hmax
