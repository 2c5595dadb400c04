/// What users set of a body on a mesh, checked, and the settings of the model that come of it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/tissue_parameters.hpp"

namespace hmax {

/// Ids of the models a mesh can be made of (problems/tissue/tissue_model.hpp), and of what moves it. The
/// first is the default.
std::vector<std::string_view> tissue_model_ids();
std::span<const std::string_view> tissue_loads();

/// How many nodes of its elements the model takes.
ElementNodes element_nodes(const TissueId& id);

/// Those of a mesh and material, with what the user sets.
/// @throws InputError  for unknown names, numbers out of range, what the model or the load does not have, and
/// what
///                     changes nothing beside the others (catalogue/models/idle_parameters.hpp)
TissueParameters tissue_parameters(const TissueId& id, const ProblemSettings& settings);

/// Those that every body has, and of the others those that were asked for.
std::vector<std::pair<std::string, double>> named_values(const TissueParameters& parameters);

/// The unit of one of them, of a region or not: "Pa" of E and of E:tumour.
std::string_view unit_of_tissue_parameter(std::string_view name);

/// The names of those of them that change nothing of the body.
std::vector<std::string> idle_parameters(const TissueId& id, const TissueParameters& parameters);

/// Whether the user gave neither a material nor a stiffness, of the whole body or of regions.
bool has_default_material(const ProblemSettings& settings);

/// Whether the user chose neither points nor an end of the body to be held, nor that nothing is.
bool has_default_support(const ProblemSettings& settings);

/// Whether a value that the material of a region has is one that the user sets, perhaps by the other name of
/// the region.
/// @throws InputError  for regions that the mesh does not have
bool is_overridden(const TissueParameters::OfRegion& set, const TissueParameters& parameters,
                   const LoadedMesh& mesh);

/// @throws InputError  for regions and points that the mesh does not have
TissueSettings tissue_settings(const TissueId& id, const TissueParameters& parameters,
                               const LoadedMesh& mesh);

}  // namespace hmax
