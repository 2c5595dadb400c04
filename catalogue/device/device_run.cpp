#include "catalogue/device/device_run.hpp"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "catalogue/device/body_patches.hpp"
#include "integrators/control.hpp"
#include "integrators/state.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

constexpr std::int64_t steps_at_once = 4096;

/// Without forces that depend on velocities the three methods of kicks and drifts are one.
bool kicks(const Method& method) {
  return method.id == "velocity_verlet" || method.id == "stormer_verlet" || method.id == "central_difference";
}

bool is_damped(const TissueSettings& settings) { return settings.alpha != 0 || settings.beta != 0; }

/// A body and its state in the memory of a device.
class BodyOnDevice {
 public:
  BodyOnDevice(Device& device, const TissueBody& body)
      : device_(device), patches_(body_patches(body, 128, device.facts().shared_memory / sizeof(double))) {
    const BodyPatches& p = patches_;
    const std::size_t q = sizeof(double) * 3 * static_cast<std::size_t>(p.points);
    step_ = {.body = {.patches = static_cast<std::int32_t>(p.begin.size()) - 1,
                      .points = p.points,
                      .free = p.free(),
                      .tets = static_cast<std::int32_t>(p.mu.size()),
                      .springs = static_cast<std::int32_t>(p.ends.size()),
                      .begin = there(p.begin),
                      .rim = there(p.rim),
                      .corners = there(p.corners),
                      .gradients = there(p.gradients),
                      .half_lambda = there(p.half_lambda),
                      .mu = there(p.mu),
                      .ends = there(p.ends),
                      .per_length = there(p.per_length),
                      .tension = there(p.tension),
                      .cubic = p.cubic,
                      .rest = there(p.rest),
                      .slots = there(p.slots),
                      .push_slot = there(p.push_slot),
                      .push = there(p.push),
                      .weight = there(p.weight),
                      .drag = there(p.drag),
                      .mass = there(p.mass),
                      .damped_by = there(p.damped_by),
                      .damping = there(p.damping),
                      .damp_end = there(p.damp_end),
                      .damps = static_cast<std::int32_t>(p.damped_by.size()),
                      .watch = p.watch},
             .move = Move::start,
             .h = 0,
             .half = 0,
             .next_half = 0,
             .q = numbers(q),
             .q_next = numbers(q),
             .v = numbers(velocities()),
             .v_next = numbers(velocities()),
             .a = numbers(velocities()),
             .left = static_cast<std::int32_t*>(device.allocate(sizeof(std::int32_t)))};
    kept_ = {numbers(q), numbers(velocities()), numbers(velocities())};
  }

  void set(const Eigen::VectorXd& y) {
    std::vector<double> q(3 * static_cast<std::size_t>(patches_.points), 0.0), v(step_.body.free * 3UL);
    visit(q, v, [&](Eigen::Index i, double& to_q, double& to_v) { to_q = y[i], to_v = y[y.size() / 2 + i]; });
    // Both, since steps write the free points alone.
    for (double* const to : {step_.q, step_.q_next}) device_.write(to, q.data(), sizeof(double) * q.size());
    device_.write(step_.v, v.data(), velocities());
    static_cast<void>(left());
  }

  [[nodiscard]] Eigen::VectorXd get() {
    std::vector<double> q(3 * static_cast<std::size_t>(patches_.points)), v(step_.body.free * 3UL);
    device_.read(q.data(), step_.q, sizeof(double) * q.size());
    device_.read(v.data(), step_.v, velocities());
    Eigen::VectorXd y(2 * static_cast<Eigen::Index>(v.size()));
    visit(q, v, [&](Eigen::Index i, double& of_q, double& of_v) { y[i] = of_q, y[y.size() / 2 + i] = of_v; });
    return y;
  }

  /// What a step needs besides (q, v): the acceleration, of methods that kick.
  void start() { run(Move::start, 0, 1); }

  void advance(bool kicks, double h, std::int64_t count) {
    if (!kicks) return run(Move::symplectic_euler, h, count);
    step_.h = h;
    step_.half = step_.next_half = h / 2;
    device_.begin(step_);
    std::swap(step_.q, step_.q_next);
    run(Move::kick_drift, h, count - 1);
    run(Move::kick, h, 1);
  }

  /// Whether a point was beyond what is watched since the last call.
  [[nodiscard]] bool left() {
    std::int32_t found = 0;
    device_.read(&found, step_.left, sizeof found);
    const std::int32_t none = 0;
    device_.write(step_.left, &none, sizeof none);
    return found != 0;
  }

  void keep() {
    device_.copy(kept_.q, step_.q, sizeof(double) * 3 * static_cast<std::size_t>(patches_.points));
    device_.copy(kept_.v, step_.v, velocities());
    device_.copy(kept_.a, step_.a, velocities());
  }
  void go_back() {
    device_.copy(step_.q, kept_.q, sizeof(double) * 3 * static_cast<std::size_t>(patches_.points));
    device_.copy(step_.v, kept_.v, velocities());
    device_.copy(step_.a, kept_.a, velocities());
  }

  /// Operations of the elements of a patch, and bytes of its elements, rims, states and point data.
  [[nodiscard]] double flops() const {
    return 210.0 * step_.body.tets + 31.0 * step_.body.springs + 10.0 * 3 * step_.body.free +
           6.0 * step_.body.damps;
  }
  [[nodiscard]] double bytes() const {
    return static_cast<double>(sizeof(PatchCorners) + 11 * sizeof(double)) * step_.body.tets +
           static_cast<double>(sizeof(PatchSpring) + 2 * sizeof(double)) * step_.body.springs +
           28.0 * step_.body.damps + 28.0 * static_cast<double>(patches_.rim.size()) +
           (3 * 5 + 2) * 8.0 * step_.body.free;
  }

 private:
  [[nodiscard]] std::size_t velocities() const { return sizeof(double) * 3 * patches_.mass.size(); }
  double* numbers(std::size_t bytes) { return static_cast<double*>(device_.allocate(bytes)); }

  template <class T>
  const T* there(const std::vector<T>& values) {
    void* const to = device_.allocate(std::max<std::size_t>(1, values.size()) * sizeof(T));
    if (!values.empty()) device_.write(to, values.data(), values.size() * sizeof(T));
    return static_cast<const T*>(to);
  }

  /// Calls use(i, q, v) for each degree of freedom of the body with its place in the arrays of the device.
  template <class Use>
  void visit(std::vector<double>& q, std::vector<double>& v, const Use& use) const {
    const auto points = static_cast<std::size_t>(patches_.points), free = patches_.mass.size();
    for (std::size_t p = 0; p < free; ++p)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto place = static_cast<std::size_t>(patches_.order[p]);
        use(static_cast<Eigen::Index>(3 * p + i), q[i * points + place], v[i * free + place]);
      }
  }

  void run(Move move, double h, std::int64_t count) {
    if (count == 0) return;
    step_.move = move;
    step_.h = h;
    device_.run(step_, patches_.shared, count);
    if (count % 2 == 0) return;
    std::swap(step_.q, step_.q_next);
    std::swap(step_.v, step_.v_next);
  }

  Device& device_;
  BodyPatches patches_;
  BodyStep step_{};
  struct {
    double *q, *v, *a;
  } kept_{};
};

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

}  // namespace

std::string unsuited_for_device(const Problem& problem, const Method& method, const RunSpec& spec) {
  if (!problem.body)
    return fmt::format("--device gpu runs bodies on meshes, and {} is none; leave it out", problem.id);
  if (spec.adaptive) return "--device gpu runs fixed steps; give --h in the place of tolerances";
  if (!kicks(method) && method.id != "symplectic_euler")
    return fmt::format(
        "--device gpu does not run {}; take symplectic_euler, velocity_verlet, stormer_verlet or central_difference",
        method.id);
  if (method.id != "velocity_verlet" && kicks(method) && is_damped(problem.body->settings()))
    return fmt::format("--device gpu runs {} without damping; take velocity_verlet or symplectic_euler",
                       method.id);
  const std::string why = unsuited_for_patches(*problem.body);
  return why.empty() ? why
                     : fmt::format("--device gpu does not run this body: it {}; leave --device out", why);
}

DeviceRun run_on_device(Device& device, const Problem& problem, const Method& method, const RunSpec& spec) {
  const AnySystem& system = std::get<AnySystem>(problem.system);
  const bool carries = kicks(method);
  RunRecord record;
  record.y = problem.y0;
  if (!admits(system, problem.y0)) {
    record.outcome = Outcome::diverged;
    return {.record = std::move(record)};
  }
  BodyOnDevice body(device, *problem.body);
  body.set(problem.y0);
  static_cast<void>(device.seconds());
  if (carries) body.start();
  Steps steps(spec, system, problem.y0);
  std::int64_t done = 0, most = steps_at_once;
  while (done < steps.count()) {
    const Proposal<double> next = steps.step(done);
    const std::int64_t count = next.last ? 1 : std::min(most, steps.count() - 1 - done);
    body.keep();
    body.advance(carries, next.h, count);
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
  record.stats.rhs = done + (diverged ? 1 : 0) + (carries ? 1 : 0);
  return {std::move(record), device.seconds(), body.flops(), body.bytes()};
}

}  // namespace hmax
