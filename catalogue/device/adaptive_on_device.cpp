#include "catalogue/device/adaptive_on_device.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "catalogue/device/device.hpp"
#include "catalogue/device/programs/device_program.hpp"
#include "catalogue/methods/bind.hpp"
#include "core/errors.hpp"
#include "integrators/breakpoints.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/integrate.hpp"

namespace hmax {

namespace {

/// Where a state lies in the memory of a device, as those of BodyStep; or a slope, whose v follows its q.
struct StateOnDevice {
  using Scalar = double;
  static constexpr int SizeAtCompileTime = Eigen::Dynamic;  // NOLINT(readability-identifier-naming): of Eigen
  double *q, *v;

  /// That is what admits() of the system asks.
  friend bool is_bounded(const StateOnDevice& /*y*/) { return true; }
};

/// Programs of an attempt, which wait until its error is asked for.
class Attempt {
 public:
  /// @param counts  of evaluations
  Attempt(BodyOnDevice<double>& of, Stats& counts)
      : body(of),
        counts_(counts),
        memory_(of.device()),
        place_(memory_.copy(of.order())),
        pieces_(static_cast<std::size_t>(blocks_of(ErrorPieces{.step = of.step()}))),
        sums_(memory_.room<double>(pieces_ * of.method().errors.size())) {}

  BodyOnDevice<double>& body;
  std::vector<DeviceProgram> programs;
  std::vector<double> times;  ///< of their evaluations [s]

  /// Runs the programs. @returns the squares of the norms of all estimates of the error of `step`
  std::vector<double> errors_squared(const BodyStep<double>& step, const AnyNorm<double>& norm) {
    ErrorPieces error{.step = step,
                      .place = place_,
                      .norm = norm,
                      .pieces = sums_,
                      .is_of_ends = body.method().kind == DeviceMethod::Kind::stabilised};
    for (const std::vector<long double>& row : body.method().errors) {
      error.step.sum = BodyOnDevice<double>::sum_of(step, row);
      programs.push_back({error});
      error.pieces += pieces_;
    }
    body.run(programs, times);
    counts_.rhs += static_cast<std::int64_t>(times.size());
    programs.clear();
    times.clear();
    std::vector<double> sums(pieces_ * body.method().errors.size()), squares;
    body.device().read(sums.data(), sums_, sizeof(double) * sums.size());
    norm.visit([&](const auto& own) {
      for (auto sum = sums.begin(); sum != sums.end();) {
        double all = 0;
        for (const auto end = sum + static_cast<std::ptrdiff_t>(pieces_); sum != end; ++sum)
          own.take(*sum, all);
        squares.push_back(own.of_all(all, error.numbers()));
      }
    });
    return squares;
  }

 private:
  Stats& counts_;
  DeviceMemory memory_;
  const std::int32_t* place_;
  std::size_t pieces_;
  double* sums_;  ///< shape (estimates, pieces)
};

/// The body as the loop over time knows a system.
class SystemOnDevice {
 public:
  using State = StateOnDevice;

  /// @param processor  the same system there
  SystemOnDevice(Attempt& attempt, const Counted<AnySystem>& processor)
      : attempt_(attempt), processor_(processor) {}

  [[nodiscard]] Eigen::Index dim() const { return processor_.dim(); }

  /// slope = f(t, y), later.
  void rhs(double t, const State& y, State& slope) const {
    BodyStep<double> step = attempt_.body.step();
    step.move = Move::slope;
    step.q = y.q, step.v = y.v;
    step.sum.slopes = slope.q, step.sum.stage = 0;
    step.evaluation = static_cast<std::int32_t>(attempt_.times.size());
    append_step(step, attempt_.programs);
    attempt_.times.push_back(processor_.inside(t));
  }
  /// The stages of a step, later. @param known  as BodyOnDevice::append_stages()
  void stages(double t, const BodyStep<double>& step, std::optional<std::int32_t> known) const {
    attempt_.body.append_stages(step, attempt_.programs, known);
    std::vector<double> times;
    attempt_.body.method().append_times(t, step.h, {}, times);
    for (std::size_t i = known ? 1 : 0; i < times.size(); ++i)
      attempt_.times.push_back(processor_.inside(times[i]));
  }

  void find_radius(double t, const State& y) const { attempt_.body.find_radius(y.q, processor_.inside(t)); }

  [[nodiscard]] bool admits(const State& y) const {
    return !attempt_.body.left() || hmax::admits(processor_, attempt_.body.get(y.q, y.v));
  }

 private:
  Attempt& attempt_;
  const Counted<AnySystem>& processor_;
};

/// ExplicitRk and StabilizedRk with their stages on a device.
class RungeKuttaOnDevice {
 public:
  explicit RungeKuttaOnDevice(Attempt& attempt) : attempt_(attempt), step_(attempt.body.step()) {}

  void init(const SystemOnDevice& /*system*/, double /*t*/, const StateOnDevice& /*y*/) {
    known_.reset();
    radius_is_due_ = true;
  }

  StepStatus attempt(const SystemOnDevice& system, double t, const StateOnDevice& y, double h,
                     StateOnDevice& y_new) {
    const BodyStep<double>& there = attempt_.body.step();
    const DeviceMethod& method = attempt_.body.method();
    y_new = y.q == there.q ? StateOnDevice{there.q_next, there.v_next} : StateOnDevice{there.q, there.v};
    if (radius_is_due_) system.find_radius(t, y);
    radius_is_due_ = false;
    attempt_.body.prepare(h);
    attempt_.body.count_steps(1);
    step_.h = h;
    step_.sum.q = step_.q = y.q, step_.sum.v = step_.v = y.v;
    step_.q_next = y_new.q, step_.v_next = y_new.v;
    system.stages(t, step_, known_);
    known_ = 0;
    if (!method.first_same_as_last) return StepStatus::ok;
    StateOnDevice last{there.sum.slopes + std::ptrdiff_t{2} * method.last_stage() * slope_size(there),
                       nullptr};
    system.rhs(t + h, y_new, last);
    return StepStatus::ok;
  }

  void accept(const StateOnDevice& /*y_new*/) {
    known_.reset();
    if (attempt_.body.method().first_same_as_last) known_ = attempt_.body.method().last_stage();
    radius_is_due_ = true;
  }

  [[nodiscard]] double longest_step() const { return attempt_.body.longest_step(); }

  double error_squared(double /*h*/, const StateOnDevice& /*y*/, const StateOnDevice& /*y_new*/,
                       const AnyNorm<double>& norm) const {
    const std::vector<double> squares = attempt_.errors_squared(step_, norm);
    return squares.size() == 1 ? squares[0] : combined_error_squared(squares[0], squares[1]);
  }

 private:
  Attempt& attempt_;
  BodyStep<double> step_;              ///< of the last attempt
  std::optional<std::int32_t> known_;  ///< the stage whose slope is the first one of the next attempt
  bool radius_is_due_ = true;
};

/// A control that looks at the start on the processor.
template <class Control>
class StartedOnProcessor {
 public:
  /// @param y  the state that a run starts from
  StartedOnProcessor(Control control, const Counted<AnySystem>& processor, const Eigen::VectorXd& y)
      : control_(std::move(control)), processor_(processor), y_(y) {}

  void start(RungeKuttaOnDevice& stepper, const SystemOnDevice& /*system*/, Span<double> span,
             const StateOnDevice& /*y*/) {
    control_.start(stepper, processor_, span, y_);
  }
  [[nodiscard]] Proposal<double> propose(double t) const { return control_.propose(t); }
  Judgement judge(const RungeKuttaOnDevice& stepper, const SystemOnDevice& system,
                  const Proposal<double>& step, const StateOnDevice& y, const StateOnDevice& y_new) {
    return control_.judge(stepper, system, step, y, y_new);
  }
  Judgement failed(const RungeKuttaOnDevice& stepper, const Proposal<double>& step) {
    return control_.failed(stepper, step);
  }

 private:
  Control control_;
  const Counted<AnySystem>& processor_;
  const Eigen::VectorXd& y_;
};

}  // namespace

RunRecord run_adaptive(BodyOnDevice<double>& body, const Problem& problem, const RunSpec& spec) {
  if (body.method().errors.empty())
    throw InputError("a method without an error estimate takes fixed steps; give --h");
  const Span<double> span{0, spec.t_end};
  Stats counts;
  Attempt attempt(body, counts);
  auto control = detail::any_adaptive<double>(spec, body.method().error_order);
  control.prepare(span);
  Eigen::VectorXd y = problem.y0;
  const auto run = [&](const Counted<AnySystem>& processor, Span<double> part, std::int64_t attempts) {
    if (!admits(processor, y)) return RunEnd<double>{Outcome::diverged, part.t0, {}};
    body.set({&y, 1});
    StateOnDevice state{body.step().q, body.step().v};
    const RunEnd<double> end =
        integrate(RungeKuttaOnDevice(attempt), SystemOnDevice(attempt, processor), part, state,
                  StartedOnProcessor(control, processor, y), ObserveNothing{}, attempts);
    y = body.get(state.q, state.v);
    return end;
  };
  const RunEnd<double> end = run_by_pieces(Counted<AnySystem>(std::get<AnySystem>(problem.system), counts),
                                           span, y, spec.max_steps, run);
  RunRecord record{end.outcome, end.t, y, end.t_state, end.stats, end.note};
  record.stats += counts;
  return record;
}

}  // namespace hmax
