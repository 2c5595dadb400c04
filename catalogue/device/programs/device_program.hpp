/// The programs that devices run: what the threads of a block do, one source for devices and the processor.
///
/// Of a program p of type P,
///   P::threads                               are the threads of a block,
///   blocks_of(p), shared_bytes_of(p)         tell its blocks and the memory that the threads of each share,
///   with_kind(p, f)                          calls f(kind) with what is known when it is compiled,
///   run_block(kind, block, p, number, shared)  is block `number`.
/// @tparam Block  its threads: each(count, f) calls f(0) .. f(count - 1) in any order, or at once; barrier()
///                ends what was begun before it
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <variant>
#include <vector>

#include "catalogue/device/programs/body_step.hpp"
#include "catalogue/device/programs/motion_program.hpp"
#include "catalogue/device/programs/newton_step.hpp"
#include "catalogue/device/programs/point_step.hpp"
#include "catalogue/device/programs/positional_step.hpp"

namespace hmax {

template <class Real>
std::int64_t blocks_of(const BodyStep<Real>& step) {
  return static_cast<std::int64_t>(step.body.patches) * step.bodies;
}
template <class Real>
std::size_t shared_bytes_of(const BodyStep<Real>& step) {
  return sizeof(Real) * static_cast<std::size_t>(step.body.shared);
}
template <class F>
void with_parts(PatchParts parts, const F& f) {
  switch (parts) {
    case PatchParts::few:
      return f(PartsConstant<PatchParts::few>{});
    case PatchParts::more:
      return f(PartsConstant<PatchParts::more>{});
    case PatchParts::tools:
      return f(PartsConstant<PatchParts::tools>{});
  }
}
template <class F>
void with_body_kind(PatchElements elements, TetLaw law, PatchParts parts, const F& f) {
  constexpr TetLaw own = TetLaw::neo_hookean;
  with_parts(parts, [&]<PatchParts known_parts>(PartsConstant<known_parts>) {
    // Of other elements few parts are more of them: their own forces need as many registers.
    constexpr PatchParts of_others = known_parts == PatchParts::few ? PatchParts::more : known_parts;
    switch (elements) {
      case PatchElements::tetrahedra:
        return with_law(law, [&]<TetLaw known>(LawConstant<known>) {
          f(BodyKind<known, PatchElements::tetrahedra, known_parts>{});
        });
      case PatchElements::of_pressures:
        return f(BodyKind<own, PatchElements::of_pressures, of_others>{});
      case PatchElements::of_ten_nodes:
        return f(BodyKind<own, PatchElements::of_ten_nodes, of_others>{});
    }
  });
}
template <class Real, class F>
void with_kind(const BodyStep<Real>& step, const F& f) {
  with_body_kind(step.body.elements, step.body.law, step.body.parts(), f);
}
template <TetLaw law, PatchElements elements, PatchParts parts, class Block, class Real>
HMAX_DEVICE void run_block(BodyKind<law, elements, parts> kind, const Block& block,
                           const BodyStep<Real>& step, std::int32_t number, void* shared) {
  body_step(kind, block, step, number % step.body.patches, number / step.body.patches, 0,
            static_cast<Real*>(shared));
}

template <class Real>
std::int64_t blocks_of(const BodySteps<Real>& all) {
  return all.bodies;
}
template <class Real>
std::size_t shared_bytes_of(const BodySteps<Real>& all) {
  return sizeof(Real) * static_cast<std::size_t>(all.shared);
}
template <class Real, class F>
void with_kind(const BodySteps<Real>& all, const F& f) {
  with_body_kind(all.elements, all.law, all.parts, f);
}
template <TetLaw law, PatchElements elements, PatchParts parts, class Block, class Real>
HMAX_DEVICE void run_block(BodyKind<law, elements, parts> kind, const Block& block,
                           const BodySteps<Real>& all, std::int32_t number, void* shared) {
  body_steps(kind, block, all, number, static_cast<Real*>(shared));
}

/// A program whose threads know nothing of each other, count_of(p) of them: run_thread(kind, p, number).
template <class P>
concept ThreadProgram = requires(const P& p) {
  { count_of(p) } -> std::same_as<std::int64_t>;
};
template <ThreadProgram P>
std::int64_t blocks_of(const P& p) {
  return (count_of(p) + P::threads - 1) / P::threads;
}
template <ThreadProgram P>
std::size_t shared_bytes_of(const P&) {
  return 0;
}
template <class Kind, class Block, ThreadProgram P>
HMAX_DEVICE void run_block(Kind kind, const Block& block, const P& p, std::int32_t number, void*) {
  const std::int64_t first = static_cast<std::int64_t>(number) * P::threads;
  const std::int64_t left = count_of(p) - first;
  block.each(left < P::threads ? static_cast<std::int32_t>(left) : P::threads,
             [&](std::int32_t n) { run_thread(kind, p, first + n); });
}

template <class F>
void with_kind(const ErrorPieces& errors, const F& f) {
  errors.norm.visit([&]<class Norm>(const Norm&) { f(std::type_identity<Norm>{}); });
}

template <class F>
void with_kind(const TetStiffness& stiffness, const F& f) {
  if (stiffness.matrix.ten_nodes) return f(OfTenNodes{});
  if (stiffness.matrix.pressures.tets) return f(OfPressures{});
  if (stiffness.matrix.law == TetLaw::green) return f(LawConstant<TetLaw::green>{});
  if (stiffness.matrix.law == TetLaw::corotational) return f(LawConstant<TetLaw::corotational>{});
  f(LawConstant<TetLaw::neo_hookean>{});  // that of small strain is constant
}

template <class F>
void with_kind(const MovePoints& move, const F& f) {
  if (!move.tetrahedron) return f(std::true_type{});
  with_law(move.step.body.law, f);
}
template <class F>
void with_kind(const MatrixBlocks& blocks, const F& f) {
  with_parts(blocks.step.body.parts(), f);
}

/// Programs of one kind.
template <class P, class F>
requires std::derived_from<P, DofProgram> || std::derived_from<P, PieceProgram> ||
    std::same_as<P, BoundPieces> || std::same_as<P, FirstKick<double>> || std::same_as<P, FirstKick<float>> ||
    std::same_as<P, VolumeShares<double>> || std::same_as<P, VolumeShares<float>> ||
    std::same_as<P, KnownStage<double>> || std::same_as<P, KnownStage<float>> ||
    std::same_as<P, SubstepBegin> || std::same_as<P, MeetColours> || std::same_as<P, PointIteration> ||
    std::same_as<P, SubstepEnd> || std::same_as<P, FormulaMotions> || std::same_as<P, PressureGradients>
void with_kind(const P&, const F& f) { f(std::true_type{}); }

template <class F>
void with_kind(const AdaptiveMotions& motions, const F& f) {
  motions.steady ? f(std::true_type{}) : f(std::false_type{});
}
template <class Motions, class F>
requires std::same_as<Motions, SharedMotions> || std::same_as<Motions, OwnMotions> ||
    std::same_as<Motions, FormulaSteps>
void with_kind(const Motions& motions, const F& f) {
  with_explicit_method(motions.method, [&]<class Method>(const Method&) { f(std::type_identity<Method>{}); });
}

/// Any of them.
struct DeviceProgram {
  std::variant<BodyStep<double>, BodyStep<float>, BodySteps<double>, BodySteps<float>, VolumeShares<double>,
               VolumeShares<float>, FirstKick<double>, FirstKick<float>, KnownStage<double>,
               KnownStage<float>, ErrorPieces, AdaptiveMotions, FormulaMotions, FormulaSteps, SharedMotions,
               OwnMotions, NewtonBegin, PressureGradients, TetStiffness, MatrixBlocks, GradientBegin,
               GradientProduct, GradientUpdate, NewtonEnd, BoundPieces, SubstepBegin, MeetColours,
               PointIteration, MovePoints, SubstepEnd>
      of;

  template <class F>
  decltype(auto) visit(const F& f) const {
    return std::visit(f, of);
  }
  /// The same later by so many evaluations of the loads.
  [[nodiscard]] DeviceProgram later(std::int32_t evaluations) const {
    DeviceProgram program = *this;
    std::visit(
        [&](auto& own) {
          if constexpr (requires { own.evaluation; }) own.evaluation += evaluations;
        },
        program.of);
    return program;
  }
  /// Whether it is known to do the same.
  [[nodiscard]] bool is(const DeviceProgram& other) const {
    return visit([&]<class P>(const P& own) {
      const P* const its = std::get_if<P>(&other.of);
      if constexpr (std::equality_comparable<P>) return its && own == *its;
      return false;
    });
  }
};

/// Appends the volumes at step.q that tetrahedra share, where they do.
template <class Real>
void append_volumes(const BodyStep<Real>& step, std::vector<DeviceProgram>& programs) {
  if (step.body.elements == PatchElements::of_pressures)
    programs.push_back({VolumeShares<Real>{step, step.evaluation}});
}

/// Appends an evaluation of the forces at (step.q, step.v), and what its move makes of them.
template <class Real>
void append_step(const BodyStep<Real>& step, std::vector<DeviceProgram>& programs) {
  append_volumes(step, programs);
  programs.push_back({step});
}

}  // namespace hmax
