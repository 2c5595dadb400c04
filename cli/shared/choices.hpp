/// The options by which several subcommands choose a problem and a method.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catalogue/methods/choice/chosen_methods.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/scenes/scene.hpp"
#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"
#include "integrators/tolerances.hpp"

namespace hmax {

/// --mesh with --unit --model --load, or --scene with --ignore; and vectors and sets that act on it
struct MeshOptions {
  std::string mesh, unit, model, load, gravity, tool_at, tool_direction, scene, ignored;
  std::vector<std::string> supports;

  void add_to(CLI::App& command);
  /// The id of the problem, empty without a mesh and a scene.
  /// @throws InputError when a model or load is given without a mesh
  [[nodiscard]] std::string problem_id() const;
  /// Whether there is a mesh or a scene.
  [[nodiscard]] bool is_given() const { return !mesh.empty() || !scene.empty(); }
  /// The scene, of which there is one. @throws InputError as read_scene()
  [[nodiscard]] const Scene& read() const;
  /// Says on standard error what the scene leaves out, and how it solves.
  /// @param takes_linear  whether the command has --linear cg:TOLERANCE,ITERATIONS, and its methods take it
  void remark_scene(Console& console, bool takes_linear = false) const;
  /// Metres in one of --unit; nothing where it is not given. @throws InputError when it is none
  [[nodiscard]] std::optional<double> metres() const;
  /// What the options say as parameters of catalogue/models/tissue_parameters.hpp. Of a scene without those
  /// in whose place values of --set and materials of --material stand, of a whole body also its regions.
  [[nodiscard]] std::vector<std::pair<std::string, double>> parameters(
      const std::vector<std::string>& set = {}, std::string_view material = {}) const;

 private:
  [[nodiscard]] std::vector<std::pair<std::string, double>> of_scene(const std::vector<std::string>& set,
                                                                     std::string_view material) const;

  mutable std::optional<Scene> read_{};
};

/// --support, sets of points as of catalogue/models/support_sets.hpp
/// @param otherwise  what holds where there is no such option
void add_support(CLI::App& command, std::vector<std::string>& sets,
                 std::string_view otherwise = "instead of one end");

/// --matrices with --alpha --beta
struct MatrixOptions {
  std::string matrices;
  std::optional<double> alpha, beta;

  void add_to(CLI::App& command);
  /// The id of the problem, empty without matrices.
  [[nodiscard]] std::string problem_id() const;
  /// alpha and beta where they are given. @throws InputError  where --set gives them, too
  [[nodiscard]] std::vector<std::pair<std::string, double>> parameters(
      const std::vector<std::string>& set) const;
};

/// --timeout [s], of a call of a plugin; --patience is its old name, which works, too
void add_timeout(CLI::App& command, std::optional<double>& seconds);

/// --set --y0
void add_settings(CLI::App& command, std::vector<std::string>& set, std::string& y0);

/// --problem, a mesh, a scene, matrices or a plugin; --set --alpha --beta --timeout --material --y0
struct ProblemChoice {
  std::string problem, plugin, material, y0;
  MeshOptions body;
  MatrixOptions own;
  std::vector<std::string> set;
  std::optional<double> timeout;
  bool takes_meshes = true;  ///< false after add_without_meshes_to()

  void add_to(CLI::App& command);
  /// The options of a command for a few states, which no body on a mesh has.
  void add_without_meshes_to(CLI::App& command);
  /// @throws InputError when something is missing or unknown
  [[nodiscard]] Problem make() const { return make_problem(id(), settings()); }
  /// Whether no model is named.
  [[nodiscard]] bool empty() const {
    return problem.empty() && plugin.empty() && own.matrices.empty() && !body.is_given();
  }
  /// What make_problem takes. @throws InputError  when a problem is missing, or given twice
  [[nodiscard]] std::string id() const;
  [[nodiscard]] ProblemSettings settings() const;
  /// @throws InputError  where it gives a parameter that `option` varies
  void refuse_varied(std::string_view name, std::string_view option) const;
  /// Says on standard error which parameters of --set change nothing of the problem that came of them, and
  /// what a scene leaves out, as remark_scene() has it.
  void remark_idle(Console& console, const Problem& made, bool takes_linear = false) const;

 private:
  void add_name_to(CLI::App& command);
  void add_rest_to(CLI::App& command);
};

/// --method or --tableau
struct MethodChoice {
  std::string method, tableau;

  void add_to(CLI::App& command);
  /// @throws InputError when both or none are given, or something is unknown
  [[nodiscard]] Method make() const;
};

/// Warns of methods that a family or `all` holds and that are not taken, with the reason.
void warn_of_left_out(Console& console, const std::vector<LeftOut>& left_out);

/// "rtol 1e-06, atol 1e-08", and {rtol, atol}
std::string in_words(const Tolerances<double>& tolerances);
Json to_json(const Tolerances<double>& tolerances);

/// --control, a word of controller_names
void add_control(CLI::App& command, std::string& control);

}  // namespace hmax
