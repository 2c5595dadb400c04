/// Newton iterations of a body in the memory of a device: what they need, and the programs of a step.
#pragma once

#include <cstdint>
#include <vector>

#include "catalogue/device/body_matrix.hpp"
#include "catalogue/device/device.hpp"
#include "catalogue/device/device_method.hpp"
#include "catalogue/device/patches/body_patches.hpp"
#include "catalogue/device/programs/device_program.hpp"

namespace hmax {

/// What truncated Newton has beside BodyStep.
class NewtonOnDevice {
 public:
  /// @param memory, body  outlive this
  NewtonOnDevice(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches,
                 const IteratedSteps& steps);

  /// The programs of a substep of h from step.q to step.q_next.
  void append(const BodyStep<double>& step, double h, std::vector<DeviceProgram>& programs) const;

  /// A run from y begins.
  void start(const Eigen::VectorXd& y);
  /// Substeps of h follow: a frozen matrix is that of h.
  void prepare(double h);

  /// Conjugate gradients since start().
  [[nodiscard]] std::int64_t iterations();
  void keep();
  void go_back();

  /// Of a step, beside its evaluations of forces.
  [[nodiscard]] double flops() const;
  [[nodiscard]] double bytes() const;

 private:
  DeviceMemory& memory_;
  const TissueBody& body_;
  IteratedSteps steps_;
  MatrixArrays pattern_;         ///< of a frozen matrix
  TissueBody::DofMatrix K_, C_;  ///< of its start
  double h_ = 0;                 ///< its own; 0: there is none
  MatrixOnDevice matrix_;
  NewtonArrays arrays_;
  std::int64_t* kept_;
};

}  // namespace hmax
