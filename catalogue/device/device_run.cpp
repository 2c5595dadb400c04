#include "catalogue/device/device_run.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "catalogue/device/body_on_device.hpp"
#include "catalogue/device/body_patches.hpp"
#include "catalogue/device/device_method.hpp"
#include "integrators/control.hpp"
#include "integrators/state.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

constexpr std::int64_t steps_at_once = 4096;

/// The steps of a run from zero to its end, the last one of its own length.
class Steps {
 public:
  explicit Steps(const RunSpec& spec, const AnySystem& system, const Eigen::VectorXd& y0)
      : control_(spec.h), count_(fixed_step_count(spec.t_end, spec.h)) {
    control_.start(0, system, Span<double>{0, spec.t_end}, y0);
  }
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] Proposal<double> step(std::int64_t n) {
    auto place = [n](std::int64_t& at) { at = n; };
    control_.visit_state(place);
    return control_.propose(0);
  }

 private:
  FixedStep<double> control_;
  std::int64_t count_;
};

template <class Real>
DeviceRun run_with(Device& device, const Problem& problem, const Method& method, const RunSpec& spec) {
  const AnySystem& system = std::get<AnySystem>(problem.system);
  const DeviceMethod known = *device_method(method);
  RunRecord record;
  record.y = problem.y0;
  if (!admits(system, problem.y0)) {
    record.outcome = Outcome::diverged;
    return {.record = std::move(record)};
  }
  BodyOnDevice<Real> body(device, *problem.body, known);
  body.set(problem.y0);
  static_cast<void>(device.seconds());
  body.start();
  Steps steps(spec, system, problem.y0);
  std::int64_t done = 0, most = steps_at_once;
  while (done < steps.count()) {
    const Proposal<double> next = steps.step(done);
    const std::int64_t count = next.last ? 1 : std::min(most, steps.count() - 1 - done);
    body.keep();
    body.advance(next.h, count);
    if (!body.left()) {
      done += count;
      most = std::min(2 * most, steps_at_once);
    } else if (count > 1) {  // again, to look at its steps one by one
      body.go_back();
      most = count / 2;
    } else if (admits(system, body.get())) {
      ++done;
    } else {
      body.go_back();
      record.outcome = Outcome::diverged;
      record.t = next.t_next;
      break;
    }
  }
  const bool diverged = record.outcome == Outcome::diverged;
  record.t_state = done > 0 ? steps.step(done - 1).t_next : 0;
  if (!diverged) record.t = record.t_state;
  record.y = body.get();
  record.stats.steps = done;
  record.stats.rhs = known.evaluations() * (done + (diverged ? 1 : 0)) + known.first_evaluations();
  return {std::move(record), device.seconds(), body.flops(), body.bytes()};
}

}  // namespace

std::string unsuited_for_device(const Problem& problem, const Method& method, const RunSpec& spec) {
  if (!problem.body)
    return fmt::format("--device gpu runs bodies on meshes, and {} is none; leave it out", problem.id);
  if (spec.adaptive) return "--device gpu runs fixed steps; give --h in the place of tolerances";
  if (!device_method(method))
    return fmt::format(
        "--device gpu does not run {}; take symplectic_euler, velocity_verlet, stormer_verlet, central_difference or an "
        "explicit Runge-Kutta method of hmax such as rk4",
        method.id);
  const std::string why = unsuited_for_patches(*problem.body);
  return why.empty() ? why
                     : fmt::format("--device gpu does not run this body: it {}; leave --device out", why);
}

DeviceRun run_on_device(Device& device, const Problem& problem, const Method& method, const RunSpec& spec,
                        Precision precision) {
  return (precision == Precision::single_precision ? run_with<float> : run_with<double>)(device, problem,
                                                                                         method, spec);
}

}  // namespace hmax
