/// Which points of a mesh the springs of a body join, and how stiff they are.
#pragma once

#include <vector>

#include "problems/mesh/topology.hpp"
#include "problems/tissue/forces/springs.hpp"
#include "problems/tissue/tissue_settings.hpp"

namespace hmax {

/// The springs of the model mass_spring: the edges first, in their order, then the further sets.
/// @throws std::invalid_argument  for a negative stiffness or damper
std::vector<SpringSet::Spring> tissue_springs(const TetMesh& mesh, const EdgeTable& edges,
                                              const MeshSurface& surface, const TissueSettings& settings);

/// The springs of a skin on the edges of the surface.
std::vector<SpringSet::Spring> skin_springs(const TetMesh& mesh, const MeshSurface& surface,
                                            const SkinSettings& skin);

/// Pairs of points opposite to an edge that two triangles of the surface share, each once, lower point first.
MeshEdges bending_pairs(const MeshSurface& surface);

/// Pairs of points opposite to a triangle that two tetrahedra share, each once, lower point first, sorted.
MeshEdges second_ring_pairs(const TetMesh& mesh);

}  // namespace hmax
