#include "catalogue/device/newton_on_device.hpp"

#include <algorithm>

namespace hmax {

NewtonOnDevice::NewtonOnDevice(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches,
                               const IteratedSteps& steps)
    : memory_(memory), steps_(steps), kept_(memory.room<std::int64_t>(1)) {
  place_matrix(body, patches);
  const auto dofs = static_cast<std::size_t>(arrays_.dofs()),
             pieces = static_cast<std::size_t>(arrays_.pieces());
  arrays_.place = memory.copy(patches.order);
  for (double** const each : {&arrays_.inertial, &arrays_.residual, &arrays_.z, &arrays_.p[0], &arrays_.p[1],
                              &arrays_.Ap, &arrays_.dq, &arrays_.matrix.diagonal})
    *each = memory.room<double>(dofs);
  for (double** const each : {&arrays_.rr, &arrays_.rz, &arrays_.pAp}) *each = memory.room<double>(pieces);
  arrays_.states = memory.room<GradientState>(static_cast<std::size_t>(steps.gradients));
  arrays_.iterations = memory.room<std::int64_t>(1);
  reset();
}

void NewtonOnDevice::place_matrix(const TissueBody& body, const BodyPatches& patches) {
  const MatrixArrays made = matrix_arrays(body, patches.number);
  const auto lists = [&](const MatrixArrays::Lists& from) {
    return TermLists{memory_.copy(from.first), memory_.copy(from.of)};
  };
  arrays_.matrix = {.points = patches.free(),
                    .blocks = static_cast<std::int32_t>(made.blocks()),
                    .sums = static_cast<std::int32_t>(made.sums()),
                    .first = memory_.copy(made.first),
                    .row = memory_.copy(made.row),
                    .column = memory_.copy(made.column),
                    .law = made.law,
                    .tets = memory_.copy(made.tets),
                    .sum = nullptr,
                    .terms = lists(made.terms),
                    .sum_of = memory_.copy(made.sum_of),
                    .rim = memory_.copy(made.rim),
                    .springs = made.springs.empty() ? nullptr : memory_.copy(made.springs),
                    .spring_terms = lists(made.spring_terms),
                    .triangles = made.triangles.empty() ? nullptr : memory_.copy(made.triangles),
                    .triangle_terms = lists(made.triangle_terms),
                    .dampers = made.dampers.empty() ? nullptr : memory_.copy(made.dampers),
                    .damper_terms = lists(made.damper_terms),
                    .damping = made.damping.empty() ? nullptr : memory_.copy(made.damping),
                    .alpha = made.alpha,
                    .values = memory_.room<double>(9 * made.blocks()),
                    .diagonal = nullptr};
  if (const std::size_t numbers = std::max(9 * made.sums(), made.constant.size()); numbers > 0)
    arrays_.matrix.sum = memory_.room<double>(numbers);
  if (!made.constant.empty())
    memory_.device().write(arrays_.matrix.sum, made.constant.data(), sizeof(double) * made.constant.size());
  terms_ = static_cast<double>(made.terms.of.size());
  spring_terms_ = static_cast<double>(made.spring_terms.of.size() + made.damper_terms.of.size() +
                                      made.triangle_terms.of.size());
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
    programs.push_back({force});
    if (newton.matrix.sums > 0)
      programs.push_back({TetStiffness{newton.matrix, step.q_next, step.body.points}});
    programs.push_back({MatrixBlocks{newton, step, step.evaluation}});
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

void NewtonOnDevice::reset() {
  const std::int64_t none = 0;
  memory_.device().write(arrays_.iterations, &none, sizeof none);
}

void NewtonOnDevice::keep() { memory_.device().copy(kept_, arrays_.iterations, sizeof *kept_); }
void NewtonOnDevice::go_back() { memory_.device().copy(arrays_.iterations, kept_, sizeof *kept_); }

double NewtonOnDevice::flops() const {
  const double blocks = arrays_.matrix.blocks, dofs = arrays_.dofs();
  const double matrix = 260 * terms_ + 60 * spring_terms_ + 20 * blocks;
  const double gradients = static_cast<double>(steps_.gradients) * (18 * blocks + 13 * dofs);
  return static_cast<double>(steps_.all()) * (matrix + gradients + 12 * dofs);
}

double NewtonOnDevice::bytes() const {
  constexpr double number = sizeof(double), place = sizeof(std::int32_t);
  const double blocks = arrays_.matrix.blocks, dofs = arrays_.dofs(), sums = arrays_.matrix.sums;
  const double constant = (arrays_.matrix.sum && arrays_.matrix.sums == 0 ? 9 * number : 0) +
                          (arrays_.matrix.damping ? 9 * number : 0);
  const double matrix =
      place * (terms_ + spring_terms_) + 2 * 9 * number * sums + (9 * number + constant + 3 * place) * blocks;
  const double gradients =
      static_cast<double>(steps_.gradients) * ((9 * number + place) * blocks + 13 * number * dofs);
  return static_cast<double>(steps_.all()) * (matrix + gradients + 14 * number * dofs);
}

}  // namespace hmax
