/// What differs by the kind of a model: facts and verbs of any problem, so that nobody else has to ask.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "catalogue/methods/problem.hpp"
#include "problems/linearity.hpp"

namespace hmax {

/// The body of a problem, for what only bodies have.
/// @param otherwise  what it means that there is none, and what to do: "so no load is brought on; look ..."
/// @throws InputError  of other kinds: "liver_forced is no body on a mesh, " and `otherwise`
const TissueBody& require_body(const Problem& problem, std::string_view otherwise);

/// Whether there is a copy_for_thread(): right-hand sides of a program cannot be made again.
bool can_be_copied(const Problem& problem);

/// The problem for a thread of its own: bodies are shared, others made once more.
Problem copy_for_thread(const Problem& problem);

/// How the Jacobian depends on state and time, from the structure of the problem: its matrices, the
/// parameters of an oscillator, the model and the contact of a body, or what the system says of itself.
/// Unknown for right-hand sides that are only called: plugins, Python.
Linearity linearity_of(const Problem& problem);

/// Whether f depends on time, of any number of states. The oscillator, bodies, the test set and formulas
/// know; of others f is compared at eight instants and nine points, to the last bit.
bool is_driven(const Problem& problem);

/// Whether the load of a body changes with time, so that one state does not tell of all; false of other
/// kinds.
bool has_moving_load(const Problem& problem);

/// The longest period of what drives a problem [s]; nothing where no period is known.
std::optional<double> period_of_load(const Problem& problem);

/// The end of the motion that is looked at where nobody names one [s]: a whole period of the load, up to a
/// hundred times the problem's own end, and that at least.
double end_of_motion(const Problem& problem);

/// How many unknowns the equations of an implicit step have: the degrees of freedom of a body, which are half
/// of y, or all states of others.
Eigen::Index unknowns_of(const Problem& problem);

/// How far a state has moved: the largest displacement of a point of a body [m], of others max |y_i|.
/// @param moved  shape (dim), or of a body its displacements, shape (dofs)
double largest_change(const Problem& problem, const Eigen::Ref<const Eigen::VectorXd>& moved);

/// Where a problem starts: its numbers, of many unknowns of matrices a digest of them, or "rest" of a body,
/// which always does.
std::string start_in_words(const Problem& problem);

/// The names of states with their units: "x [m]", "v [m/s]"; without where they are not known.
std::vector<std::string> states_with_units(const Problem& problem);

/// "E [Pa]", "nu [1]"; of one region "E:tumour [Pa]". The name alone where the unit is not known, as of
/// formulas.
std::string with_unit(const Problem& problem, std::string_view parameter);

}  // namespace hmax
