/// A sink by which a run is kept: Runner::run knows it by its type.
#pragma once

#include <utility>

#include "catalogue/methods/run.hpp"
#include "integrators/kept_run.hpp"

namespace hmax {

/// What is asked of a run that is kept: where linear equations were solved as earlier solutions have taught
/// it, which no file tells, they are factored.
inline RunSpec kept_spec(RunSpec spec) {
  if (spec.linear_solve.by == LinearSolve::By::automatic) spec.linear_solve.by = LinearSolve::By::direct;
  return spec;
}

/// Thrown where the method that is run cannot save its state.
struct StateNotSaved {};

/// Given to Runner::run as its sink, it has the run saved and resumed by a keeper. RunSpec and the runs that
/// nobody keeps know nothing of it.
class KeptSink {
 public:
  /// @param show    may be empty; a run that is resumed shows the initial state again, and then what follows
  /// @param keeper  must outlive the run
  KeptSink(Sink show, RunKeeper& keeper) : show_(std::move(show)), keeper_(&keeper) {}

  void operator()(double t, const Eigen::Ref<const Eigen::VectorXd>& y) const {
    if (show_) show_(t, y);
  }
  [[nodiscard]] bool shows() const { return static_cast<bool>(show_); }
  [[nodiscard]] RunKeeper& keeper() const { return *keeper_; }

 private:
  Sink show_;
  RunKeeper* keeper_;
};

/// Whether somebody looks at the points of a run.
inline bool shows_points(const Sink& sink) {
  const auto* kept = sink.target<KeptSink>();
  return kept ? kept->shows() : static_cast<bool>(sink);
}

}  // namespace hmax
