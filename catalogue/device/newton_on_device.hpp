/// Newton iterations of a body in the memory of a device: what they need, and the programs of a step.
#pragma once

#include <cstdint>
#include <vector>

#include "catalogue/device/body_matrix.hpp"
#include "catalogue/device/body_patches.hpp"
#include "catalogue/device/device.hpp"
#include "catalogue/device/device_method.hpp"
#include "catalogue/device/device_program.hpp"

namespace hmax {

/// What truncated Newton has beside BodyStep.
class NewtonOnDevice {
 public:
  /// @param memory  outlives this
  NewtonOnDevice(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches,
                 const IteratedSteps& steps);

  /// The programs of a substep of h from step.q to step.q_next.
  void append(const BodyStep<double>& step, double h, std::vector<DeviceProgram>& programs) const;

  /// Conjugate gradients since reset().
  [[nodiscard]] std::int64_t iterations();
  void reset();
  void keep();
  void go_back();

  /// Of a step, beside its evaluations of forces.
  [[nodiscard]] double flops() const;
  [[nodiscard]] double bytes() const;

 private:
  DeviceMemory& memory_;
  IteratedSteps steps_;
  MatrixOnDevice matrix_;
  NewtonArrays arrays_;
  std::int64_t* kept_;
};

}  // namespace hmax
