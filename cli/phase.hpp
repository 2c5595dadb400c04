/// What the views of `hmax phase` share: the chosen problem, the part of the plane, and where figures go.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/phase_plane.hpp"
#include "bench/catalogue.hpp"
#include "cli/choices.hpp"
#include "cli/console.hpp"
#include "plots/curves.hpp"

namespace hmax {

struct PhaseOptions {
  ProblemChoice problem;
  std::string window, output;
  std::optional<double> at;
};

/// A problem of two states as it is looked at: autonomous, or frozen at an instant.
struct PhaseView {
  Problem problem;          ///< as chosen
  std::optional<double> t;  ///< [s] the instant at which a driven problem is frozen
  Problem still;            ///< the problem without its time
  PlanarField field;
  Window window;
  std::vector<Equilibrium> equilibria;
  std::vector<std::string> remarks;  ///< whole sentences
};

/// @throws InputError for what cannot be shown
PhaseView view_of(const PhaseOptions& options);

/// {problem, material, parameters, states, t, window, remarks}, how every document of the command begins.
nlohmann::ordered_json document_of(const PhaseView& view);
nlohmann::ordered_json to_json(const std::vector<Equilibrium>& equilibria);
/// [[re, im], [re, im]]
nlohmann::ordered_json to_json(const std::array<std::complex<double>, 2>& eigenvalues);
/// "-0.69 ± 0.0845i" or "-0.1, -3"
std::string in_words(const std::array<std::complex<double>, 2>& eigenvalues);

/// Field, nullclines and equilibria of a view, as yet without orbits.
PhasePlane plane_of(const PhaseView& view);

/// Draws into the folder of --output and says what came of it: a line for people and the key `figure`.
void deliver(const Figure& figure, const PhaseOptions& options, const std::string& name,
             nlohmann::ordered_json& document, std::string& text, Console& console);

}  // namespace hmax
