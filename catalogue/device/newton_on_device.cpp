#include "catalogue/device/newton_on_device.hpp"

#include "integrators/positional/truncated_newton.hpp"

namespace hmax {

NewtonOnDevice::NewtonOnDevice(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches,
                               const IteratedSteps& steps)
    : memory_(memory),
      body_(body),
      steps_(steps),
      pattern_(steps.frozen ? pattern_arrays(body) : MatrixArrays{}),
      matrix_(memory, steps.frozen ? pattern_ : matrix_arrays(body, patches.number), patches),
      arrays_{},
      kept_(memory.room<std::int64_t>(1)) {
  arrays_.matrix = matrix_.there();
  const auto dofs = static_cast<std::size_t>(arrays_.matrix.dofs()),
             pieces = static_cast<std::size_t>(arrays_.matrix.pieces());
  for (double** const each : {&arrays_.inertial, &arrays_.residual, &arrays_.z, &arrays_.p[0], &arrays_.p[1],
                              &arrays_.Ap, &arrays_.dq})
    *each = memory.room<double>(dofs);
  for (double** const each : {&arrays_.rr, &arrays_.rz, &arrays_.pAp}) *each = memory.room<double>(pieces);
  arrays_.states = memory.room<GradientState>(static_cast<std::size_t>(steps.gradients));
  arrays_.iterations = memory.room<std::int64_t>(1);
}

void NewtonOnDevice::append(const BodyStep<double>& step, double h,
                            std::vector<DeviceProgram>& programs) const {
  NewtonArrays newton = arrays_;
  newton.h = h;
  programs.push_back({NewtonBegin{{newton, step}, step.evaluation}});
  BodyStep<double> force = step;
  force.move = Move::force;
  force.q = step.q_next;
  force.v = step.v_next;
  for (std::int32_t i = 0; i < steps_.iterations; ++i) {
    append_step(force, programs);
    if (!steps_.frozen) matrix_.append(h, step, programs);
    programs.push_back({GradientBegin{{newton, 0}, step}});
    for (std::int32_t k = 0; k < steps_.gradients; ++k) {
      programs.push_back({GradientProduct{{newton, k}}});
      programs.push_back({GradientUpdate{{newton, k}}});
    }
    programs.push_back({NewtonEnd{{newton, step}}});
  }
}

std::int64_t NewtonOnDevice::iterations() {
  std::int64_t count = 0;
  memory_.device().read(&count, arrays_.iterations, sizeof count);
  return count;
}

void NewtonOnDevice::start(const Eigen::VectorXd& y) {
  const std::int64_t none = 0;
  memory_.device().write(arrays_.iterations, &none, sizeof none);
  if (!steps_.frozen) return;
  body_.stiffness(0, y.head(body_.dofs()), y.tail(body_.dofs()), K_);
  body_.damping(0, y.head(body_.dofs()), y.tail(body_.dofs()), C_);
  h_ = 0;
}

void NewtonOnDevice::prepare(double h) {
  if (!steps_.frozen || h == h_) return;
  TissueBody::DofMatrix A = K_;
  TruncatedNewton::complete(A, C_, body_.mass(), h);
  const std::vector<double> entries = pattern_.entries_of(A);
  const Eigen::VectorXd diagonal = A.diagonal();
  Device& device = memory_.device();
  device.write(arrays_.matrix.values, entries.data(), sizeof(double) * entries.size());
  device.write(arrays_.matrix.diagonal, diagonal.data(),
               static_cast<std::size_t>(arrays_.matrix.dofs()) * sizeof(double));
  h_ = h;
}

void NewtonOnDevice::keep() { memory_.device().copy(kept_, arrays_.iterations, sizeof *kept_); }
void NewtonOnDevice::go_back() { memory_.device().copy(arrays_.iterations, kept_, sizeof *kept_); }

double NewtonOnDevice::flops() const {
  const double blocks = arrays_.matrix.blocks, dofs = arrays_.matrix.dofs();
  const double gradients = static_cast<double>(steps_.gradients) * (18 * blocks + 13 * dofs);
  return static_cast<double>(steps_.all()) * ((steps_.frozen ? 0 : matrix_.flops()) + gradients + 12 * dofs);
}

double NewtonOnDevice::bytes() const {
  constexpr double number = sizeof(double), place = sizeof(std::int32_t);
  const double blocks = arrays_.matrix.blocks, dofs = arrays_.matrix.dofs();
  const double gradients =
      static_cast<double>(steps_.gradients) * ((9 * number + place) * blocks + 13 * number * dofs);
  return static_cast<double>(steps_.all()) *
         ((steps_.frozen ? 0 : matrix_.bytes()) + gradients + 14 * number * dofs);
}

}  // namespace hmax
