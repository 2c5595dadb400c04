/// What the sections of `hmax reproduce tissue` share.
#pragma once

#include <functional>
#include <string>

#include "analysis/statics/static_solution.hpp"
#include "catalogue/methods/method.hpp"
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

/// Springs and finite elements over stiffness and damping, with scenes of SOFA.
ReportSection figure_9(const std::filesystem::path& folder, const TissueOptions& options);

/// Small strain and Green's strain of a body that is turned as a whole.
ReportSection turned_body(const std::filesystem::path& folder);

/// The volume that springs and finite elements lose under a load.
ReportSection kept_volume();

/// Explicit Runge-Kutta methods: stages, order, limits.
ReportSection order_and_stages();

/// h lambda of the modes in the regions of explicit methods, at several masses.
ReportSection regions_and_eigenvalues(const std::filesystem::path& folder, const TissueOptions& options);

/// Newton's methods over the tolerance of their linear systems.
/// @param relaxation  of SOR
ReportSection inner_systems(const StaticModel& model, double relaxation);

/// The inverse of the stiffness at rest beside its factors.
ReportSection pre_inversion(const StaticModel& model);

/// A fixed number of iterations for each frame of a moving load.
ReportSection pseudo_dynamics(const StaticModel& model);

/// What a hand feels at 1 kHz of tissue at 100 Hz.
ReportSection force_feedback(const std::filesystem::path& folder);

/// Linearly implicit Euler with a constant Jacobian, one step in each frame of 10 ms.
ReportSection rates(const TissueOptions& options);

/// A thigh of springs: identified from synthetic measurements, beside a network, in motion.
ReportSection identified_thigh(const std::filesystem::path& folder, const TissueOptions& options,
                               TissueStudy& tissue, const std::function<void(const std::string&)>& progress);

/// What meshes cost as they grow.
ReportSection costs_over_size(const std::filesystem::path& folder, const TissueOptions& options,
                              TissueStudy& study,
                              const std::function<void(double, const std::string&)>& progress);

}  // namespace hmax
