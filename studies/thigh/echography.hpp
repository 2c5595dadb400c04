/// The image of an echograph on a thigh that its probe deforms: by a linear rule, as a thesis does it, and by
/// finite elements with a material for each tissue. How far vein and bone are off, and up to which step.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "results/json.hpp"
#include "studies/thigh/voxel_thigh.hpp"

namespace hmax {

/// Where tissue goes, and where it was.
struct Deformation {
  std::function<Eigen::Vector3d(const Eigen::Vector3d& rest)> displacement;  ///< [m]
  Source source;                                                             ///< its inverse, as a place
};

/// The linear rule: tissue below the skin moves straight inwards, by the share of the displacement w(x, y) of
/// the skin that falls linearly from 1 at the skin to 0 at the depth D(x, y), whatever the tissue is.
///   z = d + w (1 - d / D) for a depth d < D at rest, so that d = (z - w) / (1 - w / D)
/// @param skin  w [m], less than D
/// @param reach  D [m]
Deformation linear_rule(const std::function<double(double x, double y)>& skin,
                        const std::function<double(double x, double y)>& reach);

/// Displacements at the corners of a grid of lines, linear between them along each axis. Beyond it those of
/// its rim.
struct GridField {
  std::array<std::vector<double>, 3> lines;  ///< increasing, two at least [m]
  Eigen::Matrix3Xd u;                        ///< z varies fastest, then y [m]

  [[nodiscard]] Eigen::Vector3d at(const Eigen::Vector3d& x) const;
};

/// Tissue goes with the field; its source by Newton's method, to a hundredth of a micrometre.
Deformation deformation_of(GridField field);

/// How the probe presses the thigh.
struct ThighPress {
  double depth = 0.016;     ///< of the probe [m]
  double rise = 0.1;        ///< until it is there [s]
  double damping = 50;      ///< force over velocity and mass [1/s]
  bool one_tissue = false;  ///< all of muscle
};

/// A block of Neo-Hookean elements (nu = 0.45) with the tissues of the anatomy, fixed at its foot: skin of 40
/// kPa, muscle of 8, vein of 1.5, bone of 10 MPa. A probe of 50 mm by 16 mm presses the middle of its skin.
/// Sizes and stiffnesses are assumptions.
class PressedBlock {
 public:
  PressedBlock(const ThighAnatomy& anatomy, const ThighPress& press);

  [[nodiscard]] const Problem& problem() const { return problem_; }
  /// The displacements of a state. @param q  shape (dofs)
  [[nodiscard]] GridField field(double t, const Eigen::VectorXd& q) const;
  /// Those of the equilibrium. @throws std::runtime_error  where none is found
  [[nodiscard]] GridField pressed() const;

 private:
  std::array<std::vector<double>, 3> lines_;
  Problem problem_;
};

/// Distances of a rule's displacements from those of finite elements with regions [m].
struct RuleError {
  std::string rule;
  double vein_mean = 0, vein_most = 0;  ///< in the vein under the image
  double bone_mean = 0, bone_most = 0;  ///< on the surface of the bone there
};
HMAX_RECORD(RuleError, rule, vein_mean, vein_most, bone_mean, bone_most);
RuleError rule_error(const ThighAnatomy& anatomy, const Eigen::Vector3d& probe, double width,
                     const Deformation& rule, const Deformation& truth);

/// Linearly implicit Euler, seen at each frame until vein and bone have followed the probe: the largest
/// distances from the motion for h towards 0 [m]; NaN where the run diverges.
struct FrameError {
  int steps = 1;          ///< of a frame
  bool constant = false;  ///< with the Jacobian of rest; else with a new one in each step
  double h = 0;           ///< [s]
  bool reached_end = false;
  double vein = 0, bone = 0;

  [[nodiscard]] bool within(double pixel) const { return vein < pixel && bone < pixel; }  // NaN is not
};
HMAX_RECORD(FrameError, steps, constant, h, reached_end, vein, bone);

/// The errors with 1, 2, 4, 8 and 16 steps a frame, and of the first and the last with the Jacobian of rest.
/// The motion for h towards 0 is extrapolated from 8 and 16 steps.
std::vector<FrameError> frame_errors(const ThighAnatomy& anatomy, const PressedBlock& block, double frame);

/// A slice, and where finite elements have the walls of the vein and the surface of the bone in it [pixels].
struct EchoImage {
  std::string name, title;
  std::vector<std::uint8_t> grey;
  std::vector<std::array<double, 2>> vein, bone;
};

struct Echography {
  double pixel = 0, image_distance = 0;  ///< [m]
  double bytes = 0;                      ///< of the voxels
  ThighPress press;
  GapError gaps, tissue_gaps;  ///< with speckle, and of the tissues without
  std::vector<RuleError> rules;
  double frame = 0.01;  ///< [s]
  std::vector<FrameError> steps;
  double largest_step = 0;   ///< with vein and bone within a pixel; 0 where none is [s]
  double slice_seconds = 0;  ///< CPU time of a slice deformed by finite elements [s]
  double step_seconds = 0;   ///< the same of a step of the finite elements, with a new Jacobian [s]
  std::vector<EchoImage> images;
};

/// @param progress  told what comes next; may throw to stop
Echography echography(const std::function<void(const std::string&)>& progress);

/// A slice of the synthetic thigh, of its voxels or of the images with the gaps between them filled.
struct SliceChoice {
  double x = 0.084, y = 0.06;  ///< of the middle of its upper edge on the skin [m]
  double angle = 0, tilt = 0;  ///< as of probe_frame() [rad]
  bool of_images = false;
  std::string rule = "rest";  ///< "rest", "linear", "bone" (linear to the bone) or "elements"
  double depth = 0.016;       ///< of the probe [m]
};
/// @throws InputError  for a place beyond the thigh, angles that are not finite, another rule, and a depth
/// beyond 20 mm
std::vector<std::uint8_t> chosen_slice(const SliceChoice& choice);

}  // namespace hmax
