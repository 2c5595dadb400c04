/// What the steps of a method show of a model: its stiffness, damping and frequencies.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "limits/fidelity/fidelity_model.hpp"
#include "limits/fidelity/momentum_made.hpp"
#include "limits/fidelity/shown_modes.hpp"

namespace hmax {

struct FidelityQuestion {
  double h = 0;                    ///< step, substeps and all [s]
  bool verify = false;             ///< also observe runs
  bool ceiling = false;            ///< also the stiffness ceiling
  std::optional<double> wanted{};  ///< E [Pa] that is to be shown: also the modulus to enter
  /// Called before each step; may throw.
  std::function<void()> watch{};
};

/// What steps of size h show.
///   stiffness_shown = (f . q_exact) / (f . (q_settled - q_rest)),
/// f the load, q_exact the static equilibrium of the model, q_settled where the steps come to rest, all
/// displacements from the initial position, and q_rest where they do without the load: 0 but for methods that
/// do not keep an unloaded body as it is. Where steps do not stay near q_exact, q_settled is sought from
/// where run_to_rest() comes. Of a linear body loaded at one point it is the stiffness that is felt there
/// over that of the model.
struct Fidelity {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  Method method;
  double h = 0;
  double stiffness_shown = none;  ///< 1 is exact; NaN where nothing settles
  /// The largest modulus that the steps can show, its limit as the modulus entered grows [Pa]; infinity where
  /// there is none; of bodies. A modulus is shown where the model with it sags as much.
  double stiffness_ceiling = none;
  /// E [Pa] with which the steps sag as the model does with the wanted one; NaN where none is found.
  double modulus_to_enter = none;
  /// The largest distance of a point of q_settled from q_exact, relative to the largest displacement of it.
  double settled_error = none;
  double rest_moves = 0;      ///< the largest displacement of q_rest [m]; 0 of what is no body
  double volume_kept = none;  ///< of a body: settled over that in the equilibrium of the model
  MomentumMade momentum{};  ///< of a body: in a step from that equilibrium without all that acts from outside
  std::vector<ShownMode> modes;
  struct Observed {
    double stiffness_shown = none;
    std::vector<ShownMode> modes;
  };
  std::optional<Observed> observed{};  ///< of runs from rest, and from a motion of each mode
  double gap = none;  ///< the largest relative difference of what was observed from what was predicted
  bool contradiction =
      false;           ///< runs are off by more than 5 %: one of them is wrong, or the runs are too short
  int steps = 0;       ///< that were made to find the settled state
  std::string status;  ///< sentences: what the numbers do not tell
};

/// What steps of size h make of the slowest modes of a body, about the state in which they come to rest; of
/// methods that remember earlier steps by their formula.
struct ShownDamping {
  Method method;
  double h = 0;
  std::vector<ShownMode> modes;
  double growth = Fidelity::none;  ///< the factor of a step by which a motion grows; NaN where none does
  std::string status;              ///< a sentence: what the numbers do not tell
};

/// @throws InputError  for a method that does not suit the body, or has no map of steps, and for moduli of
///                     springs of a given stiffness
Fidelity fidelity(const Method& method, const FidelityModel& model, const FidelityQuestion& question);

/// @param model  of settled_model()
/// @param h      [s]
/// @param watch  called before each step; may throw
/// @throws InputError  for a method that does not suit the body, or has neither a map of steps nor a formula
ShownDamping shown_damping(const Method& method, const FidelityModel& model, double h,
                           const std::function<void()>& watch = {});

/// What simulators step soft bodies with, as far as it suits the body.
std::vector<Method> methods_of_simulators(const Problem& problem);

/// Fidelity::stiffness_ceiling alone: where the modulus shown no longer grows with the modulus entered. NaN
/// also of springs of a given stiffness.
/// @param stiffness_shown  of the model itself
double stiffness_ceiling(const Method& method, const FidelityModel& model, const FidelityQuestion& question,
                         double stiffness_shown);

}  // namespace hmax
