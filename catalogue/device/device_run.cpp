#include "catalogue/device/device_run.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "catalogue/device/adaptive_on_device.hpp"
#include "catalogue/device/body_on_device.hpp"
#include "catalogue/device/device_method.hpp"
#include "catalogue/device/patches/body_patches.hpp"
#include "core/errors.hpp"
#include "integrators/control.hpp"
#include "integrators/state.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/positional_body.hpp"

namespace hmax {

namespace {

/// The steps of a run from zero to its end, the last one of its own length.
class Steps {
 public:
  explicit Steps(const RunSpec& spec, const AnySystem& system, const Eigen::VectorXd& y0)
      : control_(spec.h), count_(fixed_step_count(spec.t_end, spec.h)) {
    control_.start(0, system, Span<double>{0, spec.t_end}, y0);
  }
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// Where step n begins [s].
  [[nodiscard]] double begin(std::int64_t n) { return n > 0 ? step(n - 1).t_next : 0; }
  [[nodiscard]] Proposal<double> step(std::int64_t n) {
    auto place = [n](std::int64_t& at) { at = n; };
    control_.visit_state(place);
    return control_.propose(0);
  }

 private:
  FixedStep<double> control_;
  std::int64_t count_;
};

/// Tells a body whose loads change with time where the evaluations of `count` steps stand.
template <class Real>
void set_times(BodyOnDevice<Real>& body, Steps& steps, std::int64_t first, std::int64_t count) {
  if (!body.is_driven()) return;
  std::vector<double> times;
  std::optional<double> before;
  if (first > 0) before = steps.begin(first - 1) + steps.step(first - 1).h;
  for (std::int64_t n = first; n < first + count; ++n) {
    const double t = steps.begin(n), h = steps.step(n).h;
    body.method().append_times(t, h, before, times);
    before = t + h;
  }
  body.set_times(times);
}

template <class Real>
void begin(BodyOnDevice<Real>& body, const Eigen::VectorXd& y0) {
  const double start = 0;
  body.set({&y0, 1});
  if (body.is_driven()) body.set_times({&start, 1});
  body.start();
}

/// Shows the state after `done` steps, and before it what was done to solve their equations.
template <class Real>
void show(BodyOnDevice<Real>& body, const RunSpec& spec, const Sink& sink, Steps& steps, std::int64_t done) {
  if (spec.work) {
    spec.work->newton = body.method().iterated.all() * done;
    spec.work->linear_iterations = body.linear_iterations();
  }
  sink(steps.begin(done), body.get());
}

/// @param sink  may be empty
template <class Real>
RunRecord run_body(BodyOnDevice<Real>& body, const Problem& problem, const RunSpec& spec, const Sink& sink) {
  const AnySystem& system = std::get<AnySystem>(problem.system);
  const std::int64_t seen_every = sink ? spec.seen_every : BodyOnDevice<Real>::most_steps;
  const std::int64_t at_once = body.steps_at_once();
  RunRecord record;
  record.y = problem.y0;
  if (sink) sink(0, problem.y0);
  if (!admits(system, problem.y0)) {
    record.outcome = Outcome::diverged;
    return record;
  }
  begin(body, problem.y0);
  Steps steps(spec, system, problem.y0);
  std::int64_t done = 0, most = at_once;
  const auto take_counts = [&] {
    record.stats.rhs = body.evaluations() + body.method().first_evaluations();
    record.stats.linear_iterations = body.linear_iterations();
  };
  const auto advance_to = [&](std::int64_t end) {
    done = end;
    if (sink && (done % seen_every == 0 || done == steps.count())) show(body, spec, sink, steps, done);
  };
  while (done < steps.count()) {
    const Proposal<double> next = steps.step(done);
    const std::int64_t count =
        next.last ? 1 : std::min({most, steps.count() - 1 - done, seen_every - done % seen_every});
    body.keep();
    body.find_radius(body.step().q, steps.begin(done));
    body.prepare(next.h);
    set_times(body, steps, done, count);
    body.advance(next.h, count);
    if (!body.left()) {
      most = std::min(2 * most, at_once);
      advance_to(done + count);
    } else if (count > 1) {  // again, to look at its steps one by one
      body.go_back();
      most = count / 2;
    } else if (admits(system, body.get())) {
      advance_to(done + 1);
    } else {
      take_counts();
      body.go_back();
      record.outcome = Outcome::diverged;
      record.t = next.t_next;
      break;
    }
  }
  const bool diverged = record.outcome == Outcome::diverged;
  record.t_state = steps.begin(done);
  if (!diverged) record.t = record.t_state;
  record.y = body.get();
  record.stats.steps = done;
  const DeviceMethod& method = body.method();
  const std::int64_t taken = done + (diverged ? 1 : 0);
  record.stats.newton = method.iterated.all() * taken;
  record.stats.jacobian = method.jacobians(taken);
  if (!diverged) take_counts();
  return record;
}

template <class Real>
DeviceRun run_with(Device& device, const Problem& problem, const Method& method, const RunSpec& spec,
                   std::int32_t bodies) {
  const std::optional<DeviceMethod> known = device_method(method);
  known->check(sizeof(Real) == sizeof(double), bodies, spec.adaptive);
  BodyOnDevice<Real> body(device, *problem.body, *known, bodies);
  static_cast<void>(device.seconds());
  RunRecord record = [&] {
    if constexpr (std::is_same_v<Real, double>)
      if (spec.adaptive) return run_adaptive(body, problem, spec);
    return run_body(body, problem, spec, {});
  }();
  return {std::move(record), device.seconds(), body.flops(), body.bytes()};
}

}  // namespace

std::string unsuited_for_device(const Problem& problem, const Method& method) {
  if (!problem.body) return "runs on a GPU for bodies on meshes alone";
  const TissueBody& body = *problem.body;
  const std::optional<DeviceMethod> known = device_method(method);
  if (!known) return "runs on no GPU";
  using Kind = DeviceMethod::Kind;
  std::string why = unsuited_for_patches(body);
  if (known->is_positional()) {
    std::string never = PositionalBody::why_not(
        body, known->kind == Kind::constraints ? PositionalVerbs::constraints : PositionalVerbs::points);
    if (!never.empty()) return never;
    if (!body.anchors().empty()) why = "lies on springs";
  }
  if (known->kind == Kind::newton && known->iterated.programs() > IteratedSteps::most_programs)
    return "has steps of more than some " + std::to_string(IteratedSteps::most_programs / 2) +
           " conjugate gradients, the most that a step has on a GPU";
  if (why.empty() && known->kind == Kind::stabilised) why = unsuited_for_radius(body);
  return why.empty() ? why : "does not run this body on a GPU: it " + why;
}

DeviceRun run_on_device(Device& device, const Problem& problem, const Method& method, const RunSpec& spec,
                        Precision precision, std::int32_t bodies) {
  return (precision == Precision::single_precision ? run_with<float>
                                                   : run_with<double>)(device, problem, method, spec, bodies);
}

Method on_device(Method method, const std::shared_ptr<Device>& device) {
  /// What the device has of the body that was bound last, and the time of all runs.
  struct Kept {
    std::shared_ptr<const TissueBody> body{};
    std::shared_ptr<BodyOnDevice<double>> there{};
    double seconds = 0;
  };
  method.device = std::make_shared<const DeviceFacts>(device->facts());
  method.unsuited = [own = method](const Problem& problem) {
    std::string why = own.unsuited ? own.unsuited(problem) : "";
    return why.empty() ? unsuited_for_device(problem, own) : why;
  };
  const std::optional<DeviceMethod> known = device_method(method);
  method.bind = [own = method, processor = method.bind, known, device,
                 kept = std::make_shared<Kept>()](const Problem& problem) {
    if (!problem.body) return processor(problem);  // small models that tell what a method does
    if (const std::string why = own.unsuited(problem); !why.empty()) throw InputError(own.id + " " + why);
    if (kept->body != problem.body) {
      kept->there.reset();
      kept->body.reset();
      kept->there = std::make_shared<BodyOnDevice<double>>(*device, *problem.body, *known);
      kept->body = problem.body;
    }
    Runner runner;
    runner.seconds = [device, kept] { return kept->seconds += device->seconds(); };
    runner.run = [problem, device, there = kept->there](const RunSpec& spec, const Sink& sink) {
      if (spec.every > 0 || (spec.adaptive && sink))
        throw InputError("a GPU shows nothing between steps, nor steps that it chooses; leave --every out");
      return spec.adaptive ? run_adaptive(*there, problem, spec) : run_body(*there, problem, spec, sink);
    };
    runner.repeat = [run = runner.run, end = std::make_shared<Eigen::VectorXd>()](
                        const RunSpec& spec, std::int64_t runs) -> const Eigen::VectorXd& {
      for (std::int64_t i = 0; i < runs; ++i) *end = run(spec, {}).y;
      return *end;
    };
    return runner;
  };
  return method;
}

}  // namespace hmax
