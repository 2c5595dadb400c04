/// Bodies on meshes in balance: the forces to be solved for, and what to say of a body that finds none.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "analysis/static_solution.hpp"
#include "bench/catalogue.hpp"

namespace hmax {

/// The balance of forces of a body under a multiple of its load as it is at t = 0.
StaticModel static_model(const Problem& problem, double load_scale);

/// Why a search of such a balance failed, the element that gives way if one does, and the remedy.
std::string why_unbalanced(const Problem& problem, const StaticSolution& solution);

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
