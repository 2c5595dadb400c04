/// Static equilibria of bodies on meshes: the forces to be solved for, and what to say where there is none.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "analysis/static_solution.hpp"
#include "bench/catalogue.hpp"

namespace hmax {

/// The forces on a body at rest under a multiple of its load as it is at t = 0.
StaticModel static_model(const Problem& problem, double load_scale);

/// The static equilibrium under the whole load at once. Where that is not found: by load steps as short as it
/// takes, and where those end at a part of the load by dynamic relaxation from there. The history holds all
/// of it. What is found is stable, without inverted elements where the model may have none.
/// @param settings  of one load step
StaticSolution found_balance(const StaticModel& model, const StaticSettings& settings, const Clock& clock);

/// "converged", "not_converged", "collapsed" where elements lose their volume as the load grows, or
/// "inverted" where some are; small strains converge in any case.
std::string_view outcome_of(const Problem& problem, const StaticSolution& solution);

/// What is to be said of a solution: up to which share of the load there is one, the element that gives way
/// beyond it, the remedy.
/// @param converging_model  one that was found to have a solution; empty: none
std::string status_of(const Problem& problem, const StaticSolution& solution,
                      std::string_view converging_model = {});

/// The longest displacement of a point [m], q of shape (dofs).
double largest_displacement(const Eigen::VectorXd& q);

/// The number that users know a tetrahedron by: that of its file, else its place in the mesh, from 1.
std::int64_t tetrahedron_number(const Problem& problem, Eigen::Index tetrahedron);

/// "tetrahedron 17", "spring 3", "skin triangle 8": springs and triangles in their order, from 1.
struct NamedElement {
  std::string_view kind;
  std::int64_t number;
};
/// @param element  in the order of elements_of(body) (bench/fastest_mode.hpp)
NamedElement named_element(const Problem& problem, Eigen::Index element);

}  // namespace hmax
