/// What the views of `hmax phase` share: the chosen problem, the part of the plane, and where figures go.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/dynamics/fixed_point_search.hpp"
#include "analysis/dynamics/oscillator_lanes.hpp"
#include "catalogue/methods/method.hpp"
#include "cli/phase/plane.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/console.hpp"
#include "cli/shared/device_option.hpp"
#include "plots/curves.hpp"

namespace hmax {

struct PhaseOptions {
  ProblemChoice problem;
  MethodChoice method;
  std::string window, output;
  std::optional<double> at, h;
  // Basins of attraction.
  bool basins = false;
  std::string cells;
  // The stroboscopic views.
  bool poincare = false, follow = false;
  std::string bifurcation, periods, skip, points;
  std::optional<double> period, from, to;
  std::optional<double> time_limit;
  DeviceChoice device;
};

/// A problem of two states as it is looked at: autonomous, or frozen at an instant.
struct PhaseView {
  Problem problem;          ///< as chosen
  std::optional<double> t;  ///< [s] the instant at which a driven problem is frozen
  Problem still;            ///< the problem without its time
  PlanarField field;
  Window window;
  std::vector<Equilibrium> equilibria{};
  DegreeCheck check{};                 ///< what the border of the window tells of them
  std::vector<std::string> remarks{};  ///< whole sentences
};

/// --window. @throws InputError
Window parse_window(const std::string& text);
/// @throws InputError for what cannot be shown
PhaseView view_of(const PhaseOptions& options);

/// {problem, material, parameters, states}, how every document of the command begins.
Json document_of(const Problem& problem);
/// The same and {t, window, remarks, equilibria, search, tolerances}; those of orbits.
Json document_of(const PhaseView& view);
Json to_json(const std::vector<Equilibrium>& equilibria);
/// [[re, im], [re, im]]
Json eigenvalues_document(const std::array<std::complex<double>, 2>& eigenvalues);
/// "-0.69 ± 0.0845i" or "-0.1, -3"
std::string eigenvalues_in_words(const std::array<std::complex<double>, 2>& eigenvalues);
/// The same of multipliers; below 1e-9 differences of the map tell no more of one.
std::string multipliers_in_words(const Multipliers& multipliers);

/// What a search has looked for, in words.
struct Searched {
  std::string_view one, many;  ///< "equilibrium", "equilibria"
  std::string_view of;         ///< whose degree it is: "field", "map"
  std::string_view without;    ///< which of the points has no index, "degenerate"
  std::string border;          ///< when the degree is not defined
};
/// What a search in a window is worth, as a sentence.
std::string guarantee(const Problem& problem, const Window& window, const DegreeCheck& check,
                      std::size_t count, const Searched& searched);
/// {window, index_sum, degree, cut_short, status}
Json search_document(const Window& window, const DegreeCheck& check, const std::string& status);
/// guarantee() of the equilibria of a view.
std::string guarantee(const PhaseView& view);

/// "liver_cubic with m=1.45 ...", a line.
std::string headline(const Problem& problem);
/// The equilibria as a table for people, and what the search for them is worth.
std::string equilibria_table(const PhaseView& view, const Console& console);
/// At most five digits, for people.
std::string short_name(double value);

/// Where orbits begin: at the problem's own start, and all around the window.
std::vector<Eigen::Vector2d> starts_of(const PhaseView& view);
/// The ways that lead out of a saddle, or with time running backwards those that lead into it.
std::vector<Curve> ways_of(const PhaseView& view, const Equilibrium& saddle, bool into);
/// Field, nullclines, equilibria, and an orbit from each of the starts.
PhasePlane plane_of(const PhaseView& view);

/// Where motions run: on the device, or in the lanes of the processor where there is none.
/// @param at_once  motions of one call of the device
MotionRunner runner_on(Device* device, std::size_t at_once);
/// What the motions on a device, if there is one, have taken: a line for people and keys.
void add_time(Device* device, Json& document, std::string& text);

/// Draws into the folder of --output and says what came of it: a line for people and the key `figure`.
void deliver(const Figure& figure, const PhaseOptions& options, Json& document, std::string& text,
             Console& console);

/// The view of --method: what steps of a method make of the plane.
void phase_map(const PhaseOptions& options, Console& console);
/// The view of --basins: which place of rest a start leads to.
void phase_basins(const PhaseOptions& options, Console& console);
/// The view of --poincare: the state once in each period of the force.
void phase_poincare(const PhaseOptions& options, Console& console);
/// The view of --bifurcation: the same over a parameter.
void phase_bifurcation(const PhaseOptions& options, Console& console);

}  // namespace hmax
