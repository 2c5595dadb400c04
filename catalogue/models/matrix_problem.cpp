#include "catalogue/models/matrix_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/spectrum/entry_rounding.hpp"
#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "analysis/spectrum/modal_motion.hpp"
#include "catalogue/input/suggest.hpp"
#include "catalogue/models/free_parts.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "core/size_limits.hpp"
#include "problems/matrices/exchanged.hpp"

namespace hmax {

namespace {

using Eigen::VectorXd;

constexpr std::string_view lumped_word = "lumped:", series_word = "series:";
constexpr std::array<std::string_view, 7> keys{"stiffness", "mass",    "damping", "jacobian",
                                               "initial",   "storage", "drop"};

/// "stiffness", "K.mtx" for each part of an id.
std::vector<std::pair<std::string, std::string>> parts_of(std::string_view id) {
  std::vector<std::pair<std::string, std::string>> parts;
  std::string_view text = id.substr(matrices_prefix.size());
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), item.size() + 1));
    const std::size_t sign = item.find('=');
    if (sign == std::string_view::npos || sign + 1 == item.size())
      throw input_error(
          "'{}' of --matrices names no file; write for instance --matrices stiffness=K.mtx,mass=M.mtx", item);
    parts.emplace_back(item.substr(0, sign), item.substr(sign + 1));
  }
  return parts;
}

/// The part of `value` that names a file, behind a word that says how it is read.
/// @returns  whether the word stands there
/// @throws InputError  where nothing stands behind it
bool take_word(std::string_view word, const std::string& key, std::string_view example, std::string& value) {
  const std::string_view bare = word.substr(0, word.size() - 1);
  if (value == bare || value == word)
    throw input_error("{0}={1} names no file; write {0}={2}{3}", key, value, word, example);
  if (!value.starts_with(word)) return false;
  value.erase(0, word.size());
  return true;
}

void require_word(const std::string& key, const std::string& value, std::string_view word) {
  if (value != word) throw input_error("unknown word '{0}' of {1}=; write {1}={2}", value, key, word);
}

void check(const MatrixFiles& files) {
  const bool second = !files.stiffness.empty() || !files.mass.empty() || !files.damping.empty();
  if (!files.jacobian.empty() && second)
    throw InputError(
        "--matrices names a jacobian, of a first-order model, and matrices of a second-order one; give one of them");
  if (!files.jacobian.empty() && files.drop_constraints)
    throw InputError("drop=constraints applies to stiffness and mass, and a jacobian is given; remove it");
  if (files.jacobian.empty() && (files.stiffness.empty() || files.mass.empty()))
    throw input_error(
        "--matrices has no {}; write --matrices stiffness=K.mtx,mass=M.mtx, or "
        "jacobian=J.mtx for a first-order model",
        files.stiffness.empty() ? "stiffness" : "mass");
}

/// The last model that was read.
struct LastRead {
  std::mutex mutex;
  std::string id;
  std::shared_ptr<const MatrixModel> model;
};

std::shared_ptr<const MatrixModel> model_of(const std::string& id) {
  static LastRead last;
  const std::lock_guard lock(last.mutex);
  if (last.id == id) return last.model;
  last.model = nullptr;  // before another one takes memory
  last.id.clear();
  last.model = std::make_shared<const MatrixModel>(read_matrix_model(matrix_files(id)));
  last.id = id;
  return last.model;
}

/// alpha and beta. @throws InputError  for other parameters
std::array<double, 2> rayleigh_of(const std::string& id, const MatrixModel& model,
                                  const ProblemSettings& settings) {
  constexpr std::array<std::string_view, 2> names{"alpha", "beta"};
  std::array<double, 2> values{0, 0};
  for (const auto& [name, value] : settings.parameters) {
    const auto* const found = std::ranges::find(names, name);
    if (model.is_first_order())
      throw input_error("{} belongs to second-order models, and {} is y' = J y; remove it", name, id);
    if (found == names.end())
      throw input_error("unknown parameter '{}' of matrices; {}", name, suggestion(name, names));
    if (!std::isfinite(value))
      throw input_error("{} is {} but must be finite; give a number", name, to_text(value));
    values[static_cast<std::size_t>(found - names.begin())] = value;
  }
  return values;
}

/// Gershgorin's bound of the rates, without those of constraint rows [1/s].
double rate_bound(const MatrixModel& model) {
  if (!model.is_first_order()) return model.facts.constraints.others;
  VectorXd sums = VectorXd::Zero(model.size());
  for (Eigen::Index j = 0; j < model.J.cols(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(model.J, j); entry; ++entry)
      sums[entry.row()] += std::abs(entry.value());
  return sums.size() > 0 ? sums.maxCoeff() : 0;
}

/// Of matrices that change their last time, of others twenty periods of that rate, to one digit [s].
double default_end(const MatrixModel& model) {
  if (model.varying && model.varying->times().back() > 0) return model.varying->times().back();
  const double rate = rate_bound(model);
  if (!(rate > 0) || !std::isfinite(rate)) return 1;
  const double end = 20 * 2 * std::numbers::pi / rate;
  const double unit = std::pow(10, std::floor(std::log10(end)));
  return std::ceil(end / unit) * unit;
}

std::vector<std::string> state_names(const MatrixModel& model) {
  std::vector<std::string> names;
  const auto add = [&](std::string_view letter) {
    for (const Eigen::Index row : model.unknowns) {
      const auto i = static_cast<std::size_t>(row);
      names.push_back(
          fmt::format("{}{}", letter, i < model.names.size() ? model.names[i] : std::to_string(row + 1)));
    }
  };
  if (model.is_first_order()) {
    add("y");
    return names;
  }
  add("q");
  add("v");
  return names;
}

/// Mass, stiffness and damping as the system has them.
MechanicalPart part_of(const AnySystem& system) {
  const VectorXd zero = VectorXd::Zero(system.dofs());
  AnySystem::DofMatrix K, C;
  system.stiffness(0, zero, zero, K);
  system.damping(0, zero, zero, C);
  return mechanical_part(system.mass_matrix(), std::move(K), std::move(C));
}

/// The exact motion, from all modes, computed when it is first asked for.
void add_exact_motion(Problem& problem, const MatrixModel& model) {
  if (model.is_first_order() || model.size() > most_modal_dofs || !model.facts.symmetric_K ||
      model.facts.damped || model.varying)
    return;
  problem.has_exact_solution = true;
  problem.exact = states_of([system = std::get<AnySystem>(problem.system), y0 = problem.y0] {
    return ModalMotion(part_of(system), VectorXd::Zero(system.dofs()), y0);
  });
}

/// "1 mode", "2 modes"
std::string counted(Eigen::Index count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string shown(double value) { return fmt::format("{:.6g}", value); }

std::string file_name(const std::string& file) { return std::filesystem::path(file).filename().string(); }

/// "300 unknowns; K.mtx: 8910 entries, symmetric; M.mtx: ..."
std::string note_of(const MatrixModel& model) {
  const MatrixFacts& facts = model.facts;
  if (model.is_first_order())
    return fmt::format("{}: {}, {} entries{}", file_name(model.files.jacobian),
                       counted(model.size(), "state"), model.J.nonZeros(),
                       facts.symmetric_K ? ", symmetric" : "");
  std::string note =
      fmt::format("{}; {}: {} entries, {}; {}: {}, entries sum to {} kg, three times {} kg in 3-D",
                  counted(model.size(), "unknown"), file_name(model.files.stiffness), model.K.nonZeros(),
                  facts.symmetric_K ? "symmetric" : "not symmetric", file_name(model.files.mass),
                  facts.coupled_mass   ? "a mass that couples unknowns"
                  : model.files.lumped ? "sums of rows"
                                       : "a mass for each unknown",
                  shown(facts.mass), shown(facts.mass / 3));
  if (facts.damped)
    note += fmt::format("; {}: {}", file_name(model.files.damping),
                        facts.symmetric_C ? "symmetric" : "not symmetric");
  if (model.varying) {
    const std::vector<double>& times = model.varying->times();
    note += fmt::format("; given at {} times from {} to {} s, linear between them", times.size(),
                        to_text(times.front()), to_text(times.back()));
  }
  if (facts.multipliers > 0)
    note += fmt::format("; {} eliminated, with an unknown each",
                        counted(facts.multipliers, "Lagrange multiplier"));
  if (facts.massless > 0)
    note += fmt::format("; {} without mass condensed", counted(facts.massless, "unknown"));
  if (facts.dropped)
    note +=
        fmt::format("; {} left out", counted(static_cast<Eigen::Index>(facts.constraints.decoupled.size() +
                                                                       facts.constraints.penalties.size()),
                                             "constraint row"));
  return note;
}

/// "unknowns 1, 2, 3 and 9 more"
std::string rows_in_words(const MatrixModel& model, const std::vector<Eigen::Index>& rows) {
  constexpr std::size_t most = 4;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(most, rows.size()); ++i) names.push_back(model.name_of(rows[i]));
  return fmt::format("{}{}", fmt::join(names, ", "),
                     rows.size() > most ? fmt::format(" and {} more", rows.size() - most) : "");
}

void remark_constraints(const MatrixModel& model, std::vector<std::string>& remarks) {
  const ConstraintRows& rows = model.facts.constraints;
  if (rows.none() || model.facts.dropped) return;
  std::string found;
  if (!rows.penalties.empty())
    found = fmt::format("{} ({})", counted(static_cast<Eigen::Index>(rows.penalties.size()), "penalty row"),
                        rows_in_words(model, rows.penalties));
  if (!rows.decoupled.empty())
    found += fmt::format("{}{} with a diagonal alone ({})", found.empty() ? "" : " and ",
                         counted(static_cast<Eigen::Index>(rows.decoupled.size()), "row"),
                         rows_in_words(model, rows.decoupled));
  remarks.push_back(
      rows.own_the_fastest()
          ? fmt::format("the fastest mode, {1} rad/s, is that of {0}; all others have at most {2} rad/s; add "
                        "drop=constraints to --matrices to leave such rows out",
                        found, shown(rows.fastest), shown(rows.others))
          : fmt::format(
                "unknowns are held in place by {}; their modes have at most {} rad/s; drop=constraints in "
                "--matrices leaves them out",
                found, shown(rows.fastest)));
}

}  // namespace

std::string matrices_id(std::string_view text) { return fmt::format("{}{}", matrices_prefix, text); }

MatrixFiles matrix_files(const std::string& id) {
  MatrixFiles files;
  std::vector<std::string> seen;
  for (auto& [key, value] : parts_of(id)) {
    if (std::ranges::find(seen, key) != seen.end())
      throw input_error("--matrices names {} twice; remove one of them", key);
    seen.push_back(key);
    if (key == "stiffness") {
      files.stiffness_series =
          take_word(series_word, key, "K.txt for the stiffnesses that K.txt names", value);
      files.stiffness = value;
    } else if (key == "mass") {
      files.lumped = take_word(lumped_word, key, "M.mtx for the sums of the rows of M.mtx", value);
      files.mass = value;
    } else if (key == "damping") {
      files.damping_series = take_word(series_word, key, "C.txt for the matrices that C.txt names", value);
      files.damping = value;
    } else if (key == "jacobian") {
      files.jacobian = value;
    } else if (key == "initial") {
      files.initial = value;
    } else if (key == "storage") {
      require_word(key, value, "triangle");
      files.one_triangle = true;
    } else if (key == "drop") {
      require_word(key, value, "constraints");
      files.drop_constraints = true;
    } else {
      throw input_error("unknown part '{}' of --matrices; {}", key, suggestion(key, keys));
    }
  }
  check(files);
  return files;
}

std::string matrices_beside(const std::string& id, const std::string& folder) {
  std::string changed;
  for (const auto& [key, value] : parts_of(id)) {
    std::string_view word;
    for (const std::string_view each : {lumped_word, series_word})
      if (value.starts_with(each)) word = each;
    const bool is_file = key != "storage" && key != "drop";
    const std::string file = value.substr(word.size());
    changed += fmt::format("{}{}={}{}", changed.empty() ? "" : ",", key, word,
                           is_file ? (std::filesystem::path(folder) / file).string() : file);
  }
  return matrices_id(changed);
}

Problem make_matrix_problem(const std::string& id, const ProblemSettings& settings) {
  if (!settings.material.empty())
    throw InputError(
        "--material belongs to bodies and oscillators, and matrices have their own numbers; remove it");
  const std::shared_ptr<const MatrixModel> model = model_of(id);
  const auto [alpha, beta] = rayleigh_of(id, *model, settings);
  VectorXd start = model->start;
  if (!settings.y0.empty()) {
    const VectorXd given =
        Eigen::Map<const VectorXd>(settings.y0.data(), static_cast<Eigen::Index>(settings.y0.size()));
    if (!given.allFinite()) throw InputError("--y0 holds a number that is not finite; give finite numbers");
    start = start_from(*model, given, "--y0");
  }
  Problem problem{.id = id,
                  .note = note_of(*model),
                  .states = state_names(*model),
                  .t_end = default_end(*model),
                  .system = system_of(*model, alpha, beta)};
  problem.y0 = start;
  problem.matrices = model;
  if (!model->is_first_order()) problem.parameters = {{"alpha", alpha}, {"beta", beta}};
  for (const auto& [name, value] : problem.parameters)
    if (value == 0) problem.idle.push_back(name);
  add_exact_motion(problem, *model);
  return problem;
}

std::vector<double> times_of_matrices(const Problem& problem) {
  const MatrixModel* model = problem.matrices.get();
  return model && model->varying ? model->varying->times() : std::vector<double>();
}

Problem with_frozen_matrices(const Problem& problem, double t) {
  if (times_of_matrices(problem).empty()) return problem;
  Problem still = problem;
  const auto value_of = [&](std::string_view name) {
    return std::ranges::find(problem.parameters, name, &std::pair<std::string, double>::first)->second;
  };
  still.system = system_of(frozen(*problem.matrices, t), value_of("alpha"), value_of("beta"));
  return still;
}

std::optional<ModeCounts> mode_counts(const MatrixModel& model) {
  if (model.is_first_order() || model.size() > most_counted_modes || !model.facts.symmetric_K)
    return std::nullopt;
  // Sylvester's law of inertia: the signs are the same with every positive mass.
  const VectorXd mass = model.facts.coupled_mass ? VectorXd(model.M.diagonal()) : model.mass;
  const MechanicalPart part =
      mechanical_part(mass, model.K, Eigen::SparseMatrix<double>(model.size(), model.size()));
  const ExtremeStiffnesses least = smallest_stiffnesses(part, std::min<Eigen::Index>(7, model.size()));
  if (!least.converged) return std::nullopt;
  const double largest = model.facts.constraints.others * model.facts.constraints.others,
               rounding = rigid_share * largest, of_entries = entry_rounding(model.K) * largest;
  ModeCounts counts{.negative = least.negative};
  for (const double kappa : least.kappa) {
    // A negative stiffness within the rounding of the decimals of the file is none.
    const bool is_rounded = kappa < 0 && -kappa <= of_entries;
    if (is_rounded) --counts.negative;
    counts.rigid += is_rounded || std::abs(kappa) <= rounding ? 1 : 0;
  }
  return counts;
}

std::vector<std::string> matrix_remarks(const Problem& problem) {
  const MatrixModel* model = problem.matrices.get();
  if (!model) return {};
  const MatrixFacts& facts = model->facts;
  std::vector<std::string> remarks;
  if (facts.repeated > 0) remarks.push_back(fmt::format("{} duplicate entries are summed", facts.repeated));
  if (model->is_first_order()) return remarks;
  if (!facts.redundant.empty())
    remarks.push_back(
        fmt::format("the constraints of {} ({}) follow from others and are left out",
                    counted(static_cast<Eigen::Index>(facts.redundant.size()), "Lagrange multiplier"),
                    rows_in_words(*model, facts.redundant)));
  if (facts.look_swapped) remarks.emplace_back(exchanged_matrices);
  if (!facts.symmetric_K)
    remarks.push_back(
        "the stiffness is not symmetric, so the model has no energy and may grow by itself; check the file if a "
        "symmetric one is expected");
  if (facts.damped && !facts.symmetric_C)
    remarks.push_back(
        "the damping is not symmetric, as that of gyroscopic forces is; check the file if a symmetric one is "
        "expected");
  remark_constraints(*model, remarks);
  const std::optional<ModeCounts> counts = mode_counts(*model);
  if (counts && counts->negative > 0)
    remarks.push_back(
        fmt::format("{} of negative stiffness: the model is unstable, K is not that of a stable state",
                    counted(counts->negative, "mode")));
  if (counts && counts->rigid > 0)
    remarks.push_back(fmt::format("{}{} of zero frequency{}", counts->rigid == 7 ? "at least " : "",
                                  counted(counts->rigid, "mode"),
                                  counts->rigid == 6 ? ", the rigid motions of a free body in 3-D" : ""));
  else if (!counts && facts.free_directions > 0)
    remarks.push_back(
        fmt::format("K does not resist translation along {} directions: supports do not hold the model",
                    facts.free_directions));
  return remarks;
}

}  // namespace hmax
