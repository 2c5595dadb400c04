/// A synthetic thigh of voxels, the images of a probe on it, and slices through both. There are no acoustics
/// in it: grey values stand for tissues, speckle for what an echograph makes of them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "studies/thigh/thigh_model.hpp"

namespace hmax {

enum class Tissue : std::uint8_t { skin, muscle, vein, bone };

/// What lies where in a thigh that is laid flat: x around the bone, y along it, z below the skin [m]. The
/// bone lies where that of the springs does. Skin and vein are assumptions; nothing was measured.
class ThighAnatomy {
 public:
  explicit ThighAnatomy(const Thigh& thigh);

  /// Of the block [m].
  [[nodiscard]] const Eigen::Vector3d& size() const { return size_; }
  /// On the skin, of a point of the thigh [m].
  [[nodiscard]] Eigen::Vector3d place(Eigen::Index point) const;
  /// The soft tissue over the bone: linear between the points of the thigh [m].
  [[nodiscard]] double bone_depth(double x, double y) const;
  /// The middle of the vein, which runs obliquely under the middle of the thigh.
  [[nodiscard]] Eigen::Vector3d vein(double y) const;
  [[nodiscard]] Tissue at(const Eigen::Vector3d& x) const;

  static constexpr double skin_thickness = 0.002, vein_radius = 0.005;  ///< [m]

 private:
  Eigen::Index around_, along_;
  Eigen::VectorXd depths_;
  Eigen::Vector3d size_;
};

/// Grey values 0 to 255 at the corners of a regular grid that begins at the origin.
struct VoxelMap {
  std::array<Eigen::Index, 3> counts{};
  Eigen::Vector3d spacing;         ///< [m]
  std::vector<std::uint8_t> grey;  ///< z varies fastest, then y

  /// Trilinear; 0 outside.
  [[nodiscard]] double at(const Eigen::Vector3d& x) const;
};

struct VoxelSpec {
  int between = 32;          ///< layers of voxels from one row of points along the bone to the next
  double edge = 0.08 / 256;  ///< of a voxel along the bone and in depth [m]
  bool speckle = true;       ///< with the Rayleigh distribution of many scatterers; the same bits everywhere
};
VoxelMap thigh_voxels(const ThighAnatomy& anatomy, const VoxelSpec& spec = {});

/// What the probe sees at the points of the skin: the layer of voxels under each row of points along the
/// bone, where the images of neighbours overlap. `at` fills the gaps between layers linearly.
VoxelMap probe_images(const VoxelMap& voxels, int between);

/// The root of the mean squared difference of interpolated images to voxels, in grey values.
struct GapError {
  double at_points = 0;  ///< in the layers that the images show
  double halfway = 0;    ///< in those halfway between them
  double all = 0;
};
GapError gap_error(const VoxelMap& voxels, const VoxelMap& images, int between);

/// A square of pixels in space, row by row.
struct SliceFrame {
  Eigen::Vector3d corner, right, down;  ///< the first pixel, and from one to its neighbours [m]
  int pixels = 256;                     ///< of an edge
};

/// The frame of an image of the probe on the skin: from `at` downwards, `width` wide.
/// @param angle  from the direction along the bone, about the normal of the skin [rad]
/// @param tilt   out of this normal [rad]
SliceFrame probe_frame(const Eigen::Vector3d& at, double width, double angle = 0, double tilt = 0);

/// Where the tissue that is at x now was at rest.
using Source = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// Grey values of a slice, row by row. `source` is asked at every eighth pixel, and linear between. Empty:
/// the tissue is at rest.
std::vector<std::uint8_t> slice(const VoxelMap& map, const SliceFrame& frame, const Source& source = {});

}  // namespace hmax
