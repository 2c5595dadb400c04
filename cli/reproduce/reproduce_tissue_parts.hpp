/// What the sections of `hmax reproduce tissue` share.
#pragma once

#include <functional>
#include <string>

#include "bench/catalogue/catalogue.hpp"
#include "cli/reproduce/tissue_study.hpp"
#include "plots/pages/report.hpp"

namespace hmax {

/// A body of the study's material liver:male_normal.
Problem study_tissue(std::string_view model, std::string_view mesh, std::string_view load,
                     Parameters parameters);

/// What the numbers of such a body depend on, in a sentence.
std::string made_of(const Problem& problem);

/// Steps a second that explicit methods need against the mass of a particle and the stiffness of springs.
ReportSection particle_limits(const std::filesystem::path& folder, const TissueOptions& options,
                              TissueStudy& study);

/// The largest stable step while a body is loaded, and while it moves.
ReportSection path_limits(const std::filesystem::path& folder, const TissueOptions& options,
                          TissueStudy& study);

/// What meshes cost as they grow.
ReportSection costs_over_size(const std::filesystem::path& folder, const TissueOptions& options,
                              TissueStudy& study,
                              const std::function<void(double, const std::string&)>& progress);

}  // namespace hmax
