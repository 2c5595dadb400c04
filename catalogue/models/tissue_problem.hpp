/// Tissue on meshes as problems of the catalogue: "fem_green@liver", "mass_spring/press@ball:n=8".
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "catalogue/methods/method.hpp"
#include "problems/tissue/tissue_settings.hpp"

namespace hmax {

/// The id of a problem, MODEL@MESH or MODEL/LOAD@MESH; empty parts are the defaults.
std::string tissue_id(std::string_view model, std::string_view mesh, std::string_view load);

/// Whether the forces of a body are linear in its displacements and velocities: a tool touches and leaves,
/// and a skin turns with the surface. Loads and moved supports may change with time.
bool has_linear_forces(const TissueBody& body);

/// The problem of such an id, at rest at t = 0.
/// @throws InputError  for an unknown model, mesh, load, material or parameter, and for a mesh that is none
Problem make_tissue_problem(const std::string& id, const ProblemSettings& settings);

/// What a body is made of.
const TissueSettings& settings_of(const Problem& body);

/// The longest displacement of a point [m], q of shape (dofs).
double largest_displacement(const Eigen::VectorXd& q);

/// The number that users know a tetrahedron by: that of its file, else its place in the mesh, from 1.
std::int64_t tetrahedron_number(const Problem& problem, Eigen::Index tetrahedron);

/// The same of a point, as `--support points:` takes it.
std::int64_t point_number(const Problem& problem, Eigen::Index point);

/// The same problem with another body, and the start that it has: shape (dim) of this body.
Problem with_body(const Problem& problem, std::shared_ptr<const TissueBody> body);

/// The same body made of other settings, with the same name, parameters and start.
/// @throws std::invalid_argument  as TissueBody
Problem with_settings(const Problem& problem, TissueSettings settings);
/// The same body with its settings changed by `change`.
template <class Change>
requires std::invocable<Change, TissueSettings&> Problem with_settings(const Problem& problem,
                                                                       const Change& change) {
  TissueSettings settings = settings_of(problem);
  change(settings);
  return with_settings(problem, std::move(settings));
}

/// The problem once its ramps have ended, from then on: a tool that has moved in stands there from t = 0.
Problem after_ramps(const Problem& problem);

}  // namespace hmax
