/// The compliant constraints of a body in the memory of a device, and the programs of a substep.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "catalogue/device/body_patches.hpp"
#include "catalogue/device/device_memory.hpp"
#include "catalogue/device/device_method.hpp"
#include "catalogue/device/device_program.hpp"
#include "core/errors.hpp"
#include "problems/tissue/positional_body.hpp"

namespace hmax {

/// What position-based dynamics has beside BodyStep.
class ConstraintsOnDevice {
 public:
  /// @param memory  outlives this
  /// @throws InputError  where a step would have too many programs
  ConstraintsOnDevice(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches,
                      const IteratedSteps& steps)
      : steps_(steps), alpha_(body.settings().alpha), beta_(body.settings().beta) {
    place_constraints(memory, body, patches);
    place_pushes(memory, body, patches);
    const double programs = steps.substeps * (2.0 + static_cast<double>(rounds_.size()) * launches());
    constexpr int most = 1 << 16;
    if (programs > most)
      throw InputError("a step would take more than the " + std::to_string(most) +
                       " launches that it may have on a GPU; take fewer iterations or substeps");
  }

  /// The programs of a substep of h from step.q to step.q_next.
  void append(const BodyStep<double>& step, double h, std::vector<DeviceProgram>& programs) const {
    ConstraintArrays arrays = arrays_;
    arrays.rule = meeting_rule(steps_.share, h, beta_);
    arrays.h = h;
    arrays.drag = 1 + alpha_ * h;
    programs.push_back({ConstraintBegin{arrays, step, step.evaluation}});
    for (std::int32_t i = 0; i < launches(); ++i)
      for (const Round& round : rounds_)
        programs.push_back({MeetColours{.arrays = arrays,
                                        .start = step.q,
                                        .q = step.q_next,
                                        .points = step.body.points,
                                        .free = step.body.free,
                                        .first = round.first,
                                        .end = round.end,
                                        .count = round.count,
                                        .times = steps_.iterations / launches(),
                                        .is_first = i == 0,
                                        .resets = steps_.resets}});
    programs.push_back({ConstraintEnd{step, h}});
  }

  /// Of a step: about 250 operations a constraint of a tetrahedron, 60 of a spring.
  [[nodiscard]] double flops() const {
    return static_cast<double>(steps_.all()) * (60 * springs_ + 2 * 250 * tetrahedra_) +
           15 * dofs_ * steps_.substeps;
  }
  [[nodiscard]] double bytes() const {
    constexpr double number = sizeof(double), place = sizeof(std::int32_t);
    const auto of = [&](double points, double itself) {  // q is read and written
      return itself + 2 * number + place + points * (3 * 2 + 1) * number;
    };
    return static_cast<double>(steps_.all()) *
               (of(2, sizeof(DeviceSpring)) * springs_ + 2 * of(4, sizeof(DeviceTetrahedron)) * tetrahedra_) +
           8 * number * dofs_ * steps_.substeps;
  }

 private:
  /// Colours that one program meets.
  struct Round {
    std::int32_t first, end, count;
  };
  /// How often the rounds are launched in a substep.
  [[nodiscard]] std::int32_t launches() const { return rounds_.size() == 1 ? 1 : steps_.iterations; }

  void place_constraints(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches) {
    const TissueConstraints made = PositionalBody::constraints_of(body);
    const auto place = [&](TetMesh::Index free) {  // all that stand still have the displacements of the first
      return free < 0 ? patches.free() : patches.order[static_cast<std::size_t>(free)];
    };
    std::vector<DeviceSpring> springs;
    for (const TissueConstraints::Spring& each : made.springs())
      springs.push_back({{each.rest[0], each.rest[1], each.rest[2]},
                         each.length,
                         1 / each.stiffness,
                         {place(each.points[0]), place(each.points[1])}});
    std::vector<DeviceTetrahedron> tetrahedra;
    for (const TissueConstraints::Tetrahedron& each : made.tetrahedra()) {
      DeviceTetrahedron& there = tetrahedra.emplace_back();
      for (Eigen::Index k = 0; k < 9; ++k) there.gradients[k] = each.gradients(k / 3, k % 3);
      there.excess = each.excess;
      there.compliance[0] = each.deviatoric, there.compliance[1] = each.volumetric;
      for (std::size_t a = 0; a < 4; ++a) there.point[a] = place(each.points[a]);
    }
    std::vector<std::int32_t> first{0}, of;
    for (const std::vector<std::int32_t>& colour : made.colours()) {
      append_round(static_cast<std::int32_t>(first.size()) - 1, static_cast<std::int32_t>(colour.size()));
      of.insert(of.end(), colour.begin(), colour.end());
      first.push_back(static_cast<std::int32_t>(of.size()));
    }
    springs_ = static_cast<double>(springs.size()), tetrahedra_ = static_cast<double>(tetrahedra.size());
    arrays_.springs = static_cast<std::int32_t>(springs.size());
    arrays_.spring = memory.copy(springs);
    arrays_.tetrahedron = memory.copy(tetrahedra);
    arrays_.colours = {memory.copy(first), memory.copy(of)};
    arrays_.lambda = memory.room<double>(of.size());
    arrays_.weight = memory.room<double>(patches.mass.size());
  }

  /// Colours that follow each other and fit into a block are met by one program.
  void append_round(std::int32_t colour, std::int32_t count) {
    const bool fits = count <= MeetColours::threads;
    if (fits && !rounds_.empty() && rounds_.back().count <= MeetColours::threads) {
      rounds_.back().end = colour + 1;
      return;
    }
    rounds_.push_back({colour, colour + 1, count});
  }

  void place_pushes(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches) {
    const auto free = static_cast<std::size_t>(patches.free());
    std::vector<std::vector<std::int32_t>> at_point(free);
    std::vector<std::int32_t> load, first{0}, of;
    std::vector<double> share, force;
    for (const PressingForce& each : body.settings().forces) {
      for (std::size_t i = 0; i < each.points.size(); ++i) {
        const auto p = static_cast<std::size_t>(patches.number[static_cast<std::size_t>(each.points[i])]);
        if (p < free) at_point[p].push_back(static_cast<std::int32_t>(load.size()));
        load.push_back(static_cast<std::int32_t>(force.size() / 3));
        share.push_back(each.shares[i]);
      }
      force.insert(force.end(), each.force.begin(), each.force.end());
    }
    for (const std::vector<std::int32_t>& own : at_point) {
      of.insert(of.end(), own.begin(), own.end());
      first.push_back(static_cast<std::int32_t>(of.size()));
    }
    arrays_.pushes = {memory.copy(first), memory.copy(of)};
    arrays_.push_load = memory.copy(load);
    arrays_.push_share = memory.copy(share);
    arrays_.force = memory.copy(force);
    dofs_ = 3 * static_cast<double>(free);
  }

  IteratedSteps steps_;
  double alpha_, beta_;
  ConstraintArrays arrays_{};
  std::vector<Round> rounds_;
  double springs_ = 0, tetrahedra_ = 0, dofs_ = 0;
};

}  // namespace hmax
