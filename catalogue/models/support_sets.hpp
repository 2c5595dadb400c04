/// Sets of points that users hold, as they write them.
#pragma once

#include <string>
#include <vector>

#include "catalogue/models/mesh_choice.hpp"

namespace hmax {

/// The points of a mesh for models that are in each of some sets, sorted:
///   NAME                            a group or region of the file
///   region:, surface:, curve:, vertices:NAME or NUMBER   where kinds share a name, or have none
///   points:1,5,9                    by the numbers of the file; of meshes by name they count from 1
///   @FILE                           such numbers in a file, # begins a remark
///   XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX   all points in a box [m], its sides included; inf and -inf bound nothing
///   z<0.01, x>=0.2                  all points on one side of a plane across x, y or z [m], the plane
///   included
/// Points of a group that are in no tetrahedron are left out. Points that were inserted between two others
/// (ElementNodes::ten) are in a box, a plane, a region or a surface like any other, and in a list of points
/// or a group of vertices where both others are.
/// @throws InputError  for a set that is unknown, ambiguous or empty, and for points that the mesh does not
/// have
std::vector<std::vector<TetMesh::Index>> points_of_each(const std::vector<std::string>& sets,
                                                        const LoadedMesh& mesh);

/// The points of several sets together, sorted. @throws InputError  as points_of_each()
std::vector<TetMesh::Index> union_of_sets(const std::vector<std::string>& sets, const LoadedMesh& mesh);

/// The same of points that are fixed. @throws InputError  also when they are all points of the mesh
std::vector<TetMesh::Index> points_of_sets(const std::vector<std::string>& sets, const LoadedMesh& mesh);

}  // namespace hmax
