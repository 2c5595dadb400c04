/// Points and compliant constraints of a body in the memory of a device, and the programs of a substep.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "catalogue/device/device.hpp"
#include "catalogue/device/device_method.hpp"
#include "catalogue/device/patches/body_patches.hpp"
#include "catalogue/device/programs/device_program.hpp"
#include "core/errors.hpp"
#include "core/positional.hpp"
#include "integrators/positional/vertex_block_descent.hpp"
#include "problems/tissue/positional_body.hpp"

namespace hmax {

/// What such substeps have beside BodyStep, whatever moves the points: loads, colours, and the programs at
/// both ends.
class PositionalOnDevice {
 public:
  PositionalOnDevice(const PositionalOnDevice&) = delete;
  PositionalOnDevice& operator=(const PositionalOnDevice&) = delete;

 protected:
  /// Colours that one program takes.
  struct Round {
    std::int32_t first, end, count;
  };

  /// @param memory  outlives this
  PositionalOnDevice(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches,
                     const IteratedSteps& steps)
      : steps_(steps), alpha_(body.settings().alpha), dofs_(3 * static_cast<double>(patches.free())) {
    place_pushes(memory, body, patches);
  }
  ~PositionalOnDevice() = default;

  /// The number in BodyArrays of a free point; of held ones, -1, that of the first of them: all have the same
  /// displacements.
  static std::int32_t place(const BodyPatches& patches, TetMesh::Index free) {
    return free < 0 ? patches.free() : patches.order[static_cast<std::size_t>(free)];
  }

  static TermLists place_lists(DeviceMemory& memory, const std::vector<std::vector<std::int32_t>>& lists) {
    std::vector<std::int32_t> first{0}, of;
    for (const std::vector<std::int32_t>& own : lists) {
      of.insert(of.end(), own.begin(), own.end());
      first.push_back(static_cast<std::int32_t>(of.size()));
    }
    return {memory.copy(first), memory.copy(of)};
  }

  /// Those that follow each other and fit into a block are a round.
  /// @param most  that a block takes
  TermLists place_colours(DeviceMemory& memory, const Colours& colours, std::int32_t most) {
    for (std::size_t i = 0; i < colours.size(); ++i) {
      const auto colour = static_cast<std::int32_t>(i), count = static_cast<std::int32_t>(colours[i].size());
      if (count <= most && !rounds_.empty() && rounds_.back().count <= most)
        rounds_.back().end = colour + 1;
      else
        rounds_.push_back({colour, colour + 1, count});
    }
    return place_lists(memory, colours);
  }

  /// @param of_a_substep  programs
  /// @throws InputError  where a step has too many
  void check_programs(double of_a_substep) const {
    constexpr int most = 1 << 16;
    if (steps_.substeps * of_a_substep > most)
      throw InputError("a step would take more than the " + std::to_string(most) +
                       " launches that it may have on a GPU; take fewer iterations or substeps");
  }

  [[nodiscard]] SubstepBegin begin(const BodyStep<double>& step, double h, double* weight) const {
    return {pushes_, step, h, 1 + alpha_ * h, weight, step.evaluation};
  }

  IteratedSteps steps_;
  double alpha_, dofs_;
  PushArrays pushes_{};
  std::vector<Round> rounds_;

 private:
  void place_pushes(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches) {
    const auto free = static_cast<std::size_t>(patches.free());
    std::vector<std::vector<std::int32_t>> at_point(free);
    std::vector<std::int32_t> load;
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
    pushes_ = {place_lists(memory, at_point), memory.copy(load), memory.copy(share), memory.copy(force)};
  }
};

/// What position-based dynamics has.
class ConstraintsOnDevice : public PositionalOnDevice {
 public:
  /// @param memory  outlives this
  /// @throws InputError  where a step would have too many programs
  ConstraintsOnDevice(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches,
                      const IteratedSteps& steps)
      : PositionalOnDevice(memory, body, patches, steps), beta_(body.settings().beta) {
    place_constraints(memory, body, patches);
    check_programs(2.0 + static_cast<double>(rounds_.size()) * launches());
  }

  /// The programs of a substep of h from step.q to step.q_next.
  void append(const BodyStep<double>& step, double h, std::vector<DeviceProgram>& programs) const {
    ConstraintArrays arrays = arrays_;
    arrays.rule = meeting_rule(steps_.share, h, beta_);
    programs.push_back({begin(step, h, arrays.weight)});
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
    programs.push_back({SubstepEnd{step, h}});
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
  /// How often the rounds are launched in a substep.
  [[nodiscard]] std::int32_t launches() const { return rounds_.size() == 1 ? 1 : steps_.iterations; }

  void place_constraints(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches) {
    const TissueConstraints made = PositionalBody::constraints_of(body);
    const auto place = [&](TetMesh::Index free) { return PositionalOnDevice::place(patches, free); };
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
    const Colours colours = made.colours();
    springs_ = static_cast<double>(springs.size()), tetrahedra_ = static_cast<double>(tetrahedra.size());
    arrays_.springs = static_cast<std::int32_t>(springs.size());
    arrays_.spring = memory.copy(springs);
    arrays_.tetrahedron = memory.copy(tetrahedra);
    arrays_.colours = place_colours(memory, colours, MeetColours::threads);
    arrays_.lambda = memory.room<double>(springs.size() + 2 * tetrahedra.size());
    arrays_.weight = memory.room<double>(patches.mass.size());
  }

  double beta_;
  ConstraintArrays arrays_{};
  double springs_ = 0, tetrahedra_ = 0;
};

/// What vertex block descent has.
class PointsOnDevice : public PositionalOnDevice {
 public:
  /// @param memory  outlives this
  /// @throws InputError  where a step would have too many programs
  PointsOnDevice(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches,
                 const IteratedSteps& steps)
      : PositionalOnDevice(memory, body, patches, steps),
        law_(patches.law),
        damps_(static_cast<double>(patches.damped_by.size())) {
    PointPieces made = PositionalBody::pieces_of(body);
    for (std::vector<std::int32_t>& colour : made.colours)
      for (std::int32_t& point : colour) point = PositionalOnDevice::place(patches, point);
    move_.colours = place_colours(memory, made.colours, MovePoints::points);
    move_.tetrahedron = place_pieces(memory, patches, made.tetrahedra);
    move_.spring = place_pieces(memory, patches, made.springs);
    move_.pushes = pushes_;
    move_.velocity = memory.room<double>(3 * patches.mass.size());
    if (steps.rho > 0)
      for (double*& each : kept_) each = memory.room<double>(3 * patches.mass.size());
    check_programs(3.0 + static_cast<double>(rounds_.size() + 1) * steps.iterations);
  }

  /// The programs of a substep of h from step.q to step.q_next.
  void append(const BodyStep<double>& step, double h, std::vector<DeviceProgram>& programs) const {
    programs.push_back({begin(step, h, nullptr)});
    PointIteration next{step, h, 0, nullptr, nullptr, move_.velocity};
    MovePoints move = move_;
    move.step = step;
    move.h = h;
    move.evaluation = step.evaluation;
    for (std::int32_t k = 1; k <= steps_.iterations; ++k) {
      next.kept = kept_[k % 2];
      programs.push_back({next});
      for (const Round& round : rounds_) {
        move.first = round.first, move.end = round.end, move.count = round.count;
        programs.push_back({move});
      }
      next.weight = VertexBlockDescent::weight_of(steps_.rho, k, next.weight);
      if (k > 1) next.before = kept_[(k - 1) % 2];
    }
    next.kept = nullptr;
    if (next.before) programs.push_back({next});
    programs.push_back({SubstepEnd{step, h}});
  }

  /// Of a step: operations of each tetrahedron at each of its points, of each spring and of each point.
  [[nodiscard]] double flops() const {
    constexpr std::array<double, tet_laws> of_tetrahedron{220, 130, 250, 1000};
    const double of_piece = move_.tetrahedron ? of_tetrahedron[static_cast<std::size_t>(law_)] : 70;
    return static_cast<double>(steps_.all()) * (of_piece * places_ + 6 * damps_ + 40 * dofs_) +
           15 * dofs_ * steps_.substeps;
  }
  [[nodiscard]] double bytes() const {
    constexpr double number = sizeof(double), place = sizeof(std::int32_t);
    const double of_piece =
        move_.tetrahedron ? sizeof(PointTetrahedron) + 9 * number : sizeof(PointSpring) + 3 * number;
    return static_cast<double>(steps_.all()) *
               ((of_piece + place) * places_ + (4 * number + place) * damps_ + 12 * number * dofs_) +
           8 * number * dofs_ * steps_.substeps;
  }

 private:
  /// Null where there are none.
  template <class Piece>
  const Piece* place_pieces(DeviceMemory& memory, const BodyPatches& patches, std::vector<Piece>& pieces) {
    if (pieces.empty()) return nullptr;
    std::vector<std::vector<std::int32_t>> at_point(patches.mass.size());
    std::int32_t corner = 0;
    for (Piece& piece : pieces)
      for (std::int32_t& point : piece.point) {
        if (point >= 0) {
          ++places_;
          at_point[static_cast<std::size_t>(PositionalOnDevice::place(patches, point))].push_back(corner);
        }
        point = PositionalOnDevice::place(patches, point);
        ++corner;
      }
    move_.pieces = place_lists(memory, at_point);
    return memory.copy(pieces);
  }

  TetLaw law_;
  MovePoints move_{};
  double* kept_[2]{};          ///< iterates that iterations begin with; null where nobody extrapolates
  double damps_, places_ = 0;  ///< numbers of BodyArrays; of pieces at free points
};

}  // namespace hmax
