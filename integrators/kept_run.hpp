/// Runs that are saved between two steps and go on in another process with the same bits.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "integrators/integrate.hpp"
#include "integrators/saved_state.hpp"

namespace hmax {

/// Who keeps the state of a run: a file, say.
class RunKeeper {
 public:
  RunKeeper() = default;
  RunKeeper(const RunKeeper&) = delete;
  RunKeeper& operator=(const RunKeeper&) = delete;
  virtual ~RunKeeper() = default;

  /// The state that save() was given last; nothing where the run begins at its start. Asked once, before the
  /// first step and after an observer has been shown the initial state.
  virtual std::optional<std::string> resume() = 0;
  /// Whether to save now, at t; asked after each accepted step but the last.
  virtual bool is_due(double t) = 0;
  /// May throw to end the run.
  virtual void save(std::string state) = 0;
};

namespace detail {

/// A control that saves the run around it, its stepper and its observer included, where the loop asks for the
/// next step. Saving waits for an accepted step: what a stepper knows of a rejected one need not be saved.
template <class StepperT, System Sys, class Control, class Observer>
class KeptControl {
 public:
  using State = typename Sys::State;
  using Real = real_of<State>;

  /// @param counts  of the system, see Counted
  KeptControl(Control control, Observer& observer, Stats& counts, Span<Real> span, RunKeeper& keeper)
      : given_(control),
        control_(std::move(control)),
        observer_(observer),
        counts_(counts),
        span_(span),
        keeper_(keeper) {}

  /// Where the run goes on: t, and the state in y. The rest follows in start().
  Real resume(State& y) {
    std::optional<std::string> state = keeper_.resume();
    if (!state) return span_.t0;
    Real t = span_.t0;
    resumes_ = true;
    bytes_ = StateBytes(std::move(*state));
    StateLoader load(bytes_);
    load(t, y, steps_, rejected_);
    load(done_.factorisations, done_.newton, done_.linear_iterations, done_.newton_error);
    return t;
  }
  /// Accepted and rejected attempts so far, those of resume() included.
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  [[nodiscard]] std::int64_t rejected() const { return rejected_; }
  /// The work of the pieces that have ended.
  [[nodiscard]] const Stats& done() const { return done_; }

  /// A control that counts its steps starts on the whole span, one that chooses them on the piece of it. What
  /// is resumed takes the place of what init() and start() have made.
  void start(StepperT& stepper, const Sys& system, Span<Real> piece, const State& y) {
    stepper_ = &stepper;
    y_ = &y;
    accepted_ = false;  // the start of a piece is not saved: init() has just forgotten what was before it
    if constexpr (ChoosesSteps<Control>) {
      control_ = given_;
      control_.prepare(span_);
      control_.start(stepper, system, piece, y);
    } else {
      control_.start(stepper, system, span_, y);
    }
    if (!resumes_) return;
    resumes_ = false;
    StateLoader load(bytes_);
    visit_rest(load);
    if (!bytes_.at_end()) throw BadState("the state is longer than that of this run");
    if constexpr (requires { stepper.resumed(system); }) stepper.resumed(system);
    bytes_ = {};
  }

  Proposal<Real> propose(Real t) {
    if (accepted_ && keeper_.is_due(static_cast<double>(t))) save(t);
    return control_.propose(t);
  }

  Judgement judge(StepperT& stepper, const Sys& system, const Proposal<Real>& step, const State& y,
                  const State& y_new) {
    const Judgement judgement = control_.judge(stepper, system, step, y, y_new);
    if constexpr (requires { stepper.work(); })
      if (judgement == Judgement::accept && step.last) {
        Stats piece;
        piece.take(stepper.work());
        done_ += piece;
      }
    return counted(judgement);
  }
  Judgement failed(StepperT& stepper, const Proposal<Real>& step) {
    return counted(control_.failed(stepper, step));
  }

 private:
  Judgement counted(Judgement judgement) {
    accepted_ = judgement == Judgement::accept;
    ++(accepted_ ? steps_ : rejected_);
    return judgement;
  }

  void save(Real t) {
    StateBytes bytes;
    StateSaver saver(bytes);
    State y = *y_;
    saver(t, y, steps_, rejected_);
    saver(done_.factorisations, done_.newton, done_.linear_iterations, done_.newton_error);
    visit_rest(saver);
    keeper_.save(bytes.bytes());
  }

  void visit_rest(StateVisitor& visit) {
    visit(counts_.rhs, counts_.jacobian, *stepper_, control_, observer_);
  }

  Control given_, control_;  ///< as it was given, and as the run changes it
  Observer& observer_;
  Stats& counts_;
  Span<Real> span_;  ///< of the whole run
  RunKeeper& keeper_;
  StepperT* stepper_ = nullptr;  ///< that of the loop
  const State* y_ = nullptr;     ///< the last accepted state, as the loop holds it
  StateBytes bytes_;             ///< what is resumed, until start()
  std::int64_t steps_ = 0, rejected_ = 0;
  Stats done_;                               ///< work of the pieces that have ended
  bool resumes_ = false, accepted_ = false;  ///< the run goes on from a state; the last attempt was accepted
};

}  // namespace detail

/// integrate() for a run that is kept: saved where `keeper` finds it due, and resumed where that has a state.
/// A run that is interrupted and resumed ends with the bits and counts of one that is not. The state is that
/// of a run with the same system, stepper, span and control.
/// @param counts  evaluations of the system, which are saved too
/// @throws BadState  where the state that is resumed is that of another run
template <SavesState StepperT, System Sys, SavesState Control, SavesState Observer>
RunEnd<real_of<typename Sys::State>> integrate_kept(StepperT stepper, const Sys& system,
                                                    Span<real_of<typename Sys::State>> span,
                                                    typename Sys::State& y, Control control,
                                                    Observer& observer, std::int64_t max_steps, Stats& counts,
                                                    RunKeeper& keeper) {
  detail::KeptControl<StepperT, Sys, Control, Observer> kept(std::move(control), observer, counts, span,
                                                             keeper);
  Span<real_of<typename Sys::State>> rest = span;
  rest.t0 = kept.resume(y);
  const std::int64_t steps = kept.steps(), rejected = kept.rejected();
  const Stats done = kept.done();
  const auto over = [&](const Sys& of, Span<real_of<typename Sys::State>> piece, std::int64_t attempts) {
    return detail::loop(stepper, of, piece, y, kept, observer, attempts);
  };
  const std::int64_t left = max_steps - steps - rejected;
  auto end = [&] {
    if constexpr (ChoosesSteps<Control>)
      return run_by_pieces(system, rest, y, left, over);
    else
      return over(system, rest, left);
  }();
  end.stats += done;
  end.stats.steps += steps;
  end.stats.rejected += rejected;
  return end;
}

}  // namespace hmax
