/// What bodies of finite elements cost as their meshes grow.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "results/json.hpp"

namespace hmax {

class Device;  // catalogue/device/device.hpp

/// One mesh: fem_green in its weight, held at a tenth of its height. Times are CPU seconds of one thread, the
/// least of a few samples.
struct ScaleRow {
  std::string mesh;
  Eigen::Index tetrahedra = 0, points = 0, dofs = 0;
  double force = 0;
  double stiffness = 0;
  double explicit_step = 0;  ///< of symplectic_euler
  double implicit_step = 0;  ///< of linearly_implicit_euler, h = 0.01 s, by conjugate gradients to 1e-6
  double eigenvalue = 0;     ///< the largest of M^-1 K, by Lanczos iteration to 1e-6
  double import = 0;         ///< of a Gmsh file: read, checked, renumbered
  double omega = 0;          ///< the root of that eigenvalue [rad/s]
  double peak_memory = 0;    ///< of the process so far [bytes]
  /// The explicit step on a device, by its clock and without copies; NaN without one.
  double device_step = std::numeric_limits<double>::quiet_NaN();
};
HMAX_RECORD(ScaleRow, mesh, tetrahedra, dofs, force, stiffness, explicit_step, implicit_step, eigenvalue,
            import, peak_memory);

/// ball:n=K with some 1e3 to 1e6 tetrahedra.
std::vector<std::string> scale_meshes();

/// @param folder    where each mesh stands as a file while it is imported
/// @param progress  told the share that is done and which mesh comes next; may throw to stop
/// @param device    takes the explicit step too; null: none does
/// @throws InputError  for meshes that are none, and a folder that cannot be written
std::vector<ScaleRow> scale_study(std::span<const std::string> meshes, const std::filesystem::path& folder,
                                  const std::function<void(double, const std::string&)>& progress,
                                  const std::shared_ptr<Device>& device = nullptr);

}  // namespace hmax
