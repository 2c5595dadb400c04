/// Parts of bodies on meshes that supports leave free to move as a whole: their stiffness has no inverse.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "catalogue/methods/method.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

/// Modes are rigid but for rounding below this share of the largest kappa.
inline constexpr double rigid_share = 1e-12;

/// The rigid motions that supports leave at rest, orthonormal in the masses, R^T M R = I, shape
/// (dofs, count); no columns where everything is held.
Eigen::MatrixXd free_motions(const TissueBody& body);

/// The degrees of freedom of each part of which no point is held: three of each of its points, x first.
std::vector<std::vector<Eigen::Index>> loose_dofs(const TissueBody& body);

/// A sentence with the parts that are not held and what to do; empty where everything is held.
std::string free_parts_in_words(const Problem& problem);

}  // namespace hmax
