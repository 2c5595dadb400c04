/// The report of `hmax reproduce tissue` while it is made: springs and finite elements on the phantom and the
/// liver, at rest and in motion.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/statics/static_solution.hpp"
#include "catalogue/device/device.hpp"
#include "catalogue/methods/method.hpp"
#include "cli/reproduce/report_page.hpp"
#include "plots/drawn/bodies.hpp"
#include "results/json.hpp"
#include "studies/liver_claims.hpp"

namespace hmax {

/// What is made.
struct TissueOptions {
  std::string machine{};  ///< one line: where it is done
  bool quick = false;  ///< limits of the step on the phantom and at a few points of each curve, a small thigh
  bool scale = false;  ///< also what meshes of up to a million tetrahedra cost
  std::shared_ptr<Device> device = nullptr;  ///< takes steps of them too

  /// Whose limits are shown.
  [[nodiscard]] const char* mesh() const { return quick ? "phantom" : "liver"; }
};

/// Each of the functions below draws figures of the page and adds values of its text, and numbers that the
/// command tells as JSON; infinity there is a number still.
struct TissuePage {
  const TissueOptions& options;
  ReportPage page;
  Json document = {};

  /// Draws {{figure name}}.
  void draw(const BodyPicture& picture, const std::string& name);
  /// A statement of a source under this name of ours: a row of the table of statements, and of the document.
  /// @param found  the numbers that the judgement rests on
  void judge(const std::string& name, std::string_view judgement, Json found);
};

/// The material of every body here, of the table of livers.
inline constexpr const char* study_material = "male_normal";

/// Writes pictures, figures, tables and the report (README.md, index.html) into `folder`.
/// @param progress  told the share that is done and what comes next; may throw to stop
/// @returns the keys of `hmax reproduce tissue --json`
/// @throws InputError when the folder cannot be written
Json reproduce_tissue(const std::filesystem::path& folder, const TissueOptions& options,
                      const std::function<void(double, const std::string&)>& progress);

/// A body of that material.
Problem study_tissue(std::string_view model, std::string_view mesh, std::string_view load,
                     Parameters parameters);

/// What the numbers of such a body depend on, in a sentence.
std::string made_of(const Problem& problem);

/// Steps a second that explicit methods need against the mass of a particle and the stiffness of springs.
void particle_limits(TissuePage& tissue);

/// The largest stable step while a body is loaded, and while it moves.
void path_limits(TissuePage& tissue);

/// Small strain and Green's strain of a body that is turned as a whole.
void turned_body(TissuePage& tissue);

/// The volume that springs and finite elements lose under a load.
void kept_volume(TissuePage& tissue);

/// Explicit Runge-Kutta methods: stages, order, limits.
void order_and_stages(TissuePage& tissue);

/// h lambda of the modes in the regions of explicit methods, at several masses.
void regions_and_eigenvalues(TissuePage& tissue);

/// Newton's methods over the tolerance of their linear systems.
void inner_systems(TissuePage& tissue, const StaticModel& model);

/// The inverse of the stiffness at rest beside its factors.
void pre_inversion(TissuePage& tissue, const StaticModel& model);

/// A fixed number of iterations for each frame of a moving load.
void pseudo_dynamics(TissuePage& tissue, const StaticModel& model);

/// What a hand feels at 1 kHz of tissue at 100 Hz.
void force_feedback(TissuePage& tissue);

/// Linearly implicit Euler with a constant Jacobian, one step in each frame of 10 ms.
void constant_jacobian(TissuePage& tissue);

/// What a view volume around a tool finds of the surface.
void found_by_a_view(TissuePage& tissue);

/// Penalty forces of a tool: penetration, force and step over their stiffness.
void penalties(TissuePage& tissue);

/// Stress against strain of parenchyma and skin, and what a skin does to a body.
void stress_and_strain(TissuePage& tissue);

/// Which implicit methods bring solutions of dissipative equations nearer.
void contraction_of_methods(TissuePage& tissue);

/// Elasticity and damping from a measured motion.
void body_from_its_motion(TissuePage& tissue);

/// A thigh of springs: identified from synthetic measurements, beside a network, in motion.
void identified_thigh(TissuePage& tissue, const std::function<void(const std::string&)>& progress);

/// The image of an echograph on a synthetic thigh of voxels, deformed by a linear rule and by finite
/// elements.
void echographic_image(TissuePage& tissue, const std::function<void(const std::string&)>& progress);

}  // namespace hmax
