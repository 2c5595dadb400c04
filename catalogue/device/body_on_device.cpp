#include "catalogue/device/body_on_device.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>

#include "catalogue/device/programs/device_program.hpp"
#include "core/errors.hpp"

namespace hmax {

namespace {
bool has_dampers(const TissueBody& body) {
  return std::ranges::any_of(body.spring_sets(), &SpringSet::has_dampers);
}
/// Than linear and cubic springs.
bool has_other_laws(const TissueBody& body) {
  return std::ranges::any_of(body.spring_sets(), [](const SpringSet& set) { return !set.sliced(); });
}
bool is_damped(const TissueBody& body) {
  return body.settings().alpha != 0 || body.settings().beta != 0 || has_dampers(body) ||
         std::ranges::any_of(body.settings().tools, [](const SphereTool& tool) { return tool.damping != 0; });
}

/// Of many bodies each is a patch, where it fits.
std::size_t points_of_a_patch(const TissueBody& body, std::int32_t bodies) {
  constexpr std::size_t of_one = 128, most = 1024;
  const std::size_t points = body.free_points().size();
  return bodies > 1 && points <= most ? std::max(of_one, points) : of_one;
}
}  // namespace

template <class Real>
BodyOnDevice<Real>::BodyOnDevice(Device& device, const TissueBody& body, DeviceMethod method,
                                 std::int32_t bodies)
    : device_(device),
      body_(body),
      memory_(device),
      method_(std::move(method)),
      patches_(
          body_patches(body, points_of_a_patch(body, bodies), device.facts().shared_memory / sizeof(Real))),
      loads_(body.settings().forces) {
  step_.bodies = bodies;  // which the sizes of its arrays depend on
  step_ = {.body = arrays(patches_),
           .bodies = bodies,
           .move = Move::start,
           .h = 0,
           .half = 0,
           .q = numbers(displacements()),
           .q_next = numbers(displacements()),
           .v = numbers(velocities()),
           .v_next = numbers(velocities()),
           .a = numbers(velocities()),
           .half_v = nullptr,
           .lumped = nullptr,
           .left = memory_.template room<std::int32_t>(1),
           .loads = nullptr,
           .next_loads = 0,
           .evaluated = nullptr,
           .evaluation = 0,
           .sum = {},
           .recurrence = {}};
  method_.check(sizeof(Real) == sizeof(double), bodies, false);
  if (method_.kind == DeviceMethod::Kind::stabilised) radius_.emplace(memory_, body, patches_);
  place_loads();
  kept_ = {numbers(displacements()), numbers(velocities()), numbers(velocities())};
  // Without damping the three methods of kicks are one.
  if (method_.damping != KickDamping::half_step && is_damped(body)) step_.half_v = numbers(velocities());
  if (method_.damping == KickDamping::lumped && is_damped(body))
    step_.lumped = lumped_ = numbers(velocities());
  if (method_.is_iterated())
    for (Real*& q : stage_q_) q = numbers(displacements());
  if (method_.kind == DeviceMethod::Kind::newton) newton_.emplace(memory_, body, patches_, method_.iterated);
  if (method_.kind == DeviceMethod::Kind::constraints)
    constraints_.emplace(memory_, body, patches_, method_.iterated);
  if (method_.kind == DeviceMethod::Kind::points) points_.emplace(memory_, body, patches_, method_.iterated);
  if (patches_.begin.size() == 2 && !method_.is_iterated())
    programs_ = memory_.template room<BodyStep<Real>>(2 * static_cast<std::size_t>(method_.most_instants()));
  if (!method_.has_stages()) return;
  step_.sum.slopes = numbers(2 * velocities() * static_cast<std::size_t>(method_.slopes()));
  for (Real*& q : stage_q_) q = numbers(displacements());
  for (Real*& v : stage_v_) v = numbers(velocities());
}

template <class Real>
void BodyOnDevice<Real>::place_loads() {
  const bool driven = body_.steady_from() > 0;
  step_.next_loads = driven ? static_cast<std::int32_t>(numbers_of_an_evaluation()) : 0;
  const auto rows = static_cast<std::size_t>(driven ? steps_at_once() * method_.most_instants() : 1);
  load_table_ = numbers(sizeof(Real) * std::max<std::size_t>(1, numbers_of_an_evaluation() * rows));
  evaluated_ = memory_.template room<std::int64_t>(1);
  step_.loads = load_table_;
  step_.evaluated = evaluated_;
  const double start = 0;
  set_times({&start, 1});
}

template <class Real>
void BodyOnDevice<Real>::set_times(std::span<const double> times) {
  std::vector<Real> table;
  for (const double t : times) append_evaluation(t, table);
  if (!table.empty()) device_.write(load_table_, table.data(), sizeof(Real) * table.size());
  const std::int64_t none = 0;
  device_.write(evaluated_, &none, sizeof none);
}

template <class Real>
void BodyOnDevice<Real>::append_evaluation(double t, std::vector<Real>& table) const {
  for (const PressingForce& load : loads_) {
    const double factor = load.profile.value(t);
    if (numbers_of_a_load() == 1)
      table.push_back(static_cast<Real>(factor));
    else
      for (const double each : load.force) table.push_back(static_cast<Real>(factor * each));
  }
  for (const std::vector<Support>& lot : patches_.motions)
    for (double (TimeProfile::*const of)(double) const : {&TimeProfile::value, &TimeProfile::rate}) {
      Eigen::Vector3d sum = (lot.front().profile.*of)(t)*lot.front().travel;
      for (std::size_t s = 1; s < lot.size(); ++s) sum += (lot[s].profile.*of)(t)*lot[s].travel;
      for (const double each : sum) table.push_back(static_cast<Real>(each));
    }
  for (const SphereTool& tool : body_.settings().tools) {
    const SpherePose<double> pose = tool.pose(t);
    for (const double each : pose.centre) table.push_back(static_cast<Real>(each));
    for (const double each : pose.velocity) table.push_back(static_cast<Real>(each));
  }
  for (const TimeProfile& profile : patches_.rates) table.push_back(static_cast<Real>(profile.rate(t)));
}

template <class Real>
std::vector<Real> BodyOnDevice<Real>::lumped_damping(std::span<const Eigen::VectorXd> y) const {
  const std::size_t free = patches_.mass.size();
  std::vector<Real> lumped;
  lumped.reserve(3 * free * bodies());
  TissueBody::DofMatrix C;
  for (const Eigen::VectorXd& own : y) {
    body_.damping(0, own.head(body_.dofs()), own.tail(body_.dofs()), C);
    const std::size_t first = lumped.size();
    lumped.resize(first + 3 * free);
    for (std::size_t n = 0; n < 3 * free; ++n) {
      const auto i = static_cast<Eigen::Index>(n);
      lumped[first + n % 3 * free + static_cast<std::size_t>(patches_.order[n / 3])] =
          static_cast<Real>(C.coeff(i, i) / body_.mass()[i]);
    }
  }
  while (lumped.size() < 3 * free * bodies()) lumped.push_back(lumped[lumped.size() - 3 * free]);
  return lumped;
}

template <class Real>
BodyArrays<Real> BodyOnDevice<Real>::arrays(const BodyPatches& p) {
  return {.patches = static_cast<std::int32_t>(p.begin.size()) - 1,
          .points = p.points,
          .free = p.free(),
          .tets = static_cast<std::int32_t>(p.mu.size()),
          .fibres = static_cast<std::int32_t>(p.fibre_corners.size()),
          .springs = static_cast<std::int32_t>(p.ends.size()),
          .sets = static_cast<std::int32_t>(body_.spring_sets().size()),
          .dampers = static_cast<std::int32_t>(p.damper.size()),
          .triangles = static_cast<std::int32_t>(p.skin.size()),
          .begin = there(p.begin),
          .rim = there(p.rim),
          .law = p.law,
          .elements = p.elements,
          .corners = there(p.corners),
          .gradients = there(p.gradients),
          .half_lambda = there(p.half_lambda),
          .mu = there(p.mu),
          .fibre_corners = there(p.fibre_corners),
          .fibre = there(p.fibre),
          .fibres_of_small_strain = p.fibres_of_small_strain,
          .pressures = pressures(),
          .ten_nodes = there(p.ten_nodes),
          .ends = there(p.ends),
          .per_length = there(p.per_length),
          .tension = there(p.tension),
          .set_begin = there(p.set_begin),
          .laws = there(laws()),
          .has_other_laws = has_other_laws(body_),
          .damped = there(p.damped),
          .damper = there(p.damper),
          .skin = there(p.skin),
          .skin_gradients = there(p.skin_gradients),
          .skin_volume = there(p.skin_volume),
          .skin_modulus = static_cast<Real>(p.skin_modulus),
          .skin_poisson = static_cast<Real>(p.skin_poisson),
          .tools = tools(),
          .rest = there(p.rest),
          .slots = there(p.slots),
          .groups = there(p.groups),
          .push_slot = there(p.push_slot),
          .push_load = there(p.push_load),
          .push_share = there(p.push_share),
          .weight = there(p.weight),
          .drag = there(p.drag),
          .mass = there(p.mass),
          .anchor = p.anchor.empty() ? nullptr : there(p.anchor),
          .motions = static_cast<std::int32_t>(p.motions.size()),
          .first_motion = first_motion(),
          .moved_by = there(p.moved_by),
          .support_drag = {static_cast<std::int32_t>(p.rates.size()), first_rate(), there(p.support_drag)},
          .damped_by = there(p.damped_by),
          .damping = there(p.damping),
          .damp_end = there(p.damp_end),
          .damps = static_cast<std::int32_t>(p.damped_by.size()),
          .watch = static_cast<Real>(p.watch),
          .shared = static_cast<std::int32_t>(p.shared)};
}

template <class Real>
std::vector<SetLaw<Real>> BodyOnDevice<Real>::laws() {
  using Kind = typename SetLaw<Real>::Kind;
  std::vector<SetLaw<Real>> all;
  for (const SpringSet& set : body_.spring_sets()) {
    SetLaw<Real>& own = all.emplace_back(SetLaw<Real>{.kind = Kind::cubic, .b = 0, .lines = {}});
    if (const auto* const cubic = std::get_if<CubicSpring>(&set.law())) own.b = static_cast<Real>(cubic->b);
    if (const auto* const exponential = std::get_if<ExponentialSpring>(&set.law())) {
      own.kind = Kind::exponential;
      own.b = static_cast<Real>(exponential->b);
    }
    if (const auto* const table = std::get_if<TableSpring>(&set.law())) {
      const SpringLines<double> lines = table->lines();
      const auto copy = [&](const double* from) {
        return there(std::vector<double>(from, from + lines.count));
      };
      own.kind = Kind::table;
      own.lines = {copy(lines.strain), copy(lines.value), copy(lines.rise), lines.count};
    }
  }
  return all;
}

template <class Real>
BodyTools<Real> BodyOnDevice<Real>::tools() {
  std::vector<PatchContact<Real>> contacts;
  for (const PatchContact<double>& each : patches_.contacts)
    contacts.push_back(
        {each.triangle, each.tool, {each.samples.divisions, static_cast<Real>(each.samples.share)}});
  std::vector<SphereLaw<Real>> laws;
  for (const SphereTool& tool : body_.settings().tools)
    laws.push_back(
        {static_cast<Real>(tool.radius), static_cast<Real>(tool.stiffness), static_cast<Real>(tool.damping)});
  return {static_cast<std::int32_t>(contacts.size()), there(contacts), there(laws), first_tool()};
}

template <class Real>
SharedPressures<Real> BodyOnDevice<Real>::pressures() {
  const BodyPatches& p = patches_;
  if (p.elements != PatchElements::of_pressures) return {};
  return {.tets = static_cast<std::int32_t>(p.tetrahedra.size()),
          .tet = there(p.tetrahedra),
          .volume = there(p.volume),
          .corners = there(p.averages),
          .average = there(p.average),
          .ends = there(p.average_ends),
          .among = there(p.among),
          .lambda = there(p.average_lambda),
          .around = there(p.average_volume),
          .shares = numbers(sizeof(Real) * p.tetrahedra.size() * bodies())};
}

template <class Real>
const Real* BodyOnDevice<Real>::there(const std::vector<double>& values) {
  return there<Real>(std::vector<Real>(values.begin(), values.end()));
}

template <class Real>
template <class Use>
void BodyOnDevice<Real>::visit(std::size_t number, std::vector<Real>& q, std::vector<Real>& v,
                               const Use& use) const {
  const auto points = static_cast<std::size_t>(patches_.points), free = patches_.mass.size();
  for (std::size_t p = 0; p < free; ++p)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto place = static_cast<std::size_t>(patches_.order[p]);
      const std::size_t row = 3 * number + i;
      use(static_cast<Eigen::Index>(3 * p + i), q[row * points + place], v[row * free + place]);
    }
}

template <class Real>
void BodyOnDevice<Real>::set(std::span<const Eigen::VectorXd> y) {
  std::vector<Real> q(displacements() / sizeof(Real), 0.0), v(velocities() / sizeof(Real));
  for (std::size_t n = 0; n < bodies(); ++n)
    visit(n, q, v, [&own = y[y.size() == 1 ? 0 : n]](Eigen::Index i, Real& to_q, Real& to_v) {
      to_q = static_cast<Real>(own[i]), to_v = static_cast<Real>(own[own.size() / 2 + i]);
    });
  // All of them, since steps write the free points alone.
  for (Real* const to : {step_.q, step_.q_next, stage_q_[0], stage_q_[1]})
    if (to) device_.write(to, q.data(), displacements());
  device_.write(step_.v, v.data(), velocities());
  if (lumped_) device_.write(lumped_, lumped_damping(y).data(), velocities());
  if (newton_) newton_->start(y[0]);
  counted_ = {};
  static_cast<void>(left());
}

template <class Real>
Eigen::VectorXd BodyOnDevice<Real>::get(const Real* from_q, const Real* from_v, std::int32_t number) const {
  std::vector<Real> q(3 * static_cast<std::size_t>(patches_.points)), v(3 * patches_.mass.size());
  const auto n = static_cast<std::size_t>(number);
  device_.read(q.data(), from_q + n * q.size(), q.size() * sizeof(Real));
  device_.read(v.data(), from_v + n * v.size(), v.size() * sizeof(Real));
  Eigen::VectorXd y(2 * static_cast<Eigen::Index>(v.size()));
  visit(0, q, v, [&](Eigen::Index i, Real& of_q, Real& of_v) { y[i] = of_q, y[y.size() / 2 + i] = of_v; });
  return y;
}

template <class Real>
template <class Append>
void BodyOnDevice<Real>::run(std::int64_t count, const Append& append) {
  const auto swap = [this] {
    std::swap(step_.q, step_.q_next);
    std::swap(step_.v, step_.v_next);
  };
  const auto instants = static_cast<std::int32_t>(method_.instants());
  std::vector<DeviceProgram> programs;  // of two steps, there and back
  append(step_, programs);
  const std::size_t one = programs.size();
  if (count > 1) {
    swap();
    BodyStep<Real> back = step_;
    back.evaluation += instants;
    append(back, programs);
    swap();
    run(programs, count / 2, 2 * instants);
  }
  if (count % 2 == 0) return;
  run(std::span(programs).first(one), 1, instants);
  swap();
}

template <class Real>
void BodyOnDevice<Real>::run(std::span<const DeviceProgram> programs, std::int64_t times,
                             std::int32_t instants) {
  if (!programs_) return device_.run(programs, times, {evaluated_, instants});
  std::vector<BodyStep<Real>> steps;
  for (const DeviceProgram& each : programs)
    if (const auto* const step = std::get_if<BodyStep<Real>>(&each.of)) steps.push_back(*step);
  device_.write(programs_, steps.data(), steps.size() * sizeof steps.front());
  const DeviceProgram all{BodySteps<Real>{.steps = programs_,
                                          .count = static_cast<std::int32_t>(steps.size()),
                                          .times = times,
                                          .bodies = step_.bodies,
                                          .shared = step_.body.shared,
                                          .law = step_.body.law,
                                          .parts = step_.body.parts(),
                                          .elements = step_.body.elements}};
  device_.run({&all, 1}, 1, {evaluated_, static_cast<std::int32_t>(times) * instants});
}

template <class Real>
void BodyOnDevice<Real>::start() {
  if (method_.kind == DeviceMethod::Kind::kicks)
    run(1, [](BodyStep<Real> step, std::vector<DeviceProgram>& programs) {
      step.move = Move::start;
      append_step(step, programs);
    });
}

template <class Real>
void BodyOnDevice<Real>::run(std::span<const DeviceProgram> programs, std::span<const double> times) {
  if (is_driven()) set_times(times);
  device_.run(programs, 1, {evaluated_, 0});
}

template <class Real>
StageSum<Real> BodyOnDevice<Real>::sum_of(const BodyStep<Real>& step, std::span<const long double> weights) {
  StageSum<Real> sum = step.sum;
  sum.terms = 0;
  for (std::size_t j = 0; j < weights.size(); ++j)
    if (weights[j] != 0) {
      sum.slope[sum.terms] = static_cast<std::int32_t>(j);
      sum.weight[sum.terms++] = step.h * static_cast<Real>(weights[j]);
    }
  return sum;
}

template <class Real>
void BodyOnDevice<Real>::append_stages(BodyStep<Real> step, std::vector<DeviceProgram>& programs,
                                       std::optional<std::int32_t> known) const {
  if constexpr (std::is_same_v<Real, double>)
    if (method_.kind == DeviceMethod::Kind::stabilised) return append_recurrence(step, programs, known);
  const BodyStep<Real> whole = step;
  const std::size_t stages = method_.rows.size();
  step.move = Move::stage;
  step.sum.q = whole.q, step.sum.v = whole.v;
  for (std::size_t i = 0; i < stages; ++i) {
    step.sum = sum_of(step, std::span(method_.rows[i]).first(i + 1));
    step.sum.stage = static_cast<std::int32_t>(i);
    step.sum.is_end = i + 1 == stages;
    step.q_next = step.sum.is_end ? whole.q_next : stage_q_[i % 2];
    step.v_next = step.sum.is_end ? whole.v_next : stage_v_[i % 2];
    if (i == 0 && known) {
      programs.push_back({KnownStage<Real>{step, *known}});
    } else {
      append_step(step, programs);
      ++step.evaluation;
    }
    step.q = step.q_next, step.v = step.v_next;
  }
}

template <class Real>
void BodyOnDevice<Real>::append_recurrence(BodyStep<double> step, std::vector<DeviceProgram>& programs,
                                           std::optional<std::int32_t> known) const {
  if constexpr (std::is_same_v<Real, double>) {
    const std::vector<StabilizedStage<double>>& stages = method_.by_radius.stages;
    // Y_j stands where the step ends for j = s, s - 2, ..., in the other place for the others.
    double *const q[]{step.q_next, stage_q_[0]}, *const v[]{step.v_next, stage_v_[0]};
    step.move = Move::stage;
    step.sum.q = step.recurrence.q = step.q, step.sum.v = step.recurrence.v = step.v;
    step.sum.stage = 0, step.sum.is_end = false;
    step.sum.terms = 1, step.sum.slope[0] = 0;
    for (std::size_t j = 0; j < stages.size(); ++j) {
      const std::size_t place = (stages.size() - 1 - j) % 2;
      step.recurrence.stage = stages[j].times(step.h);
      step.sum.weight[0] = step.recurrence.stage.mu_f;
      step.q_next = q[place], step.v_next = v[place];
      if (j == 0 && known) {
        programs.push_back({KnownStage<double>{step, *known}});
      } else {
        append_step(step, programs);
        ++step.evaluation;
      }
      step.move = Move::recurrence;
      step.q = step.q_next, step.v = step.v_next;
      if (j > 0) step.recurrence.q = q[1 - place], step.recurrence.v = v[1 - place];
    }
  }
}

template <class Real>
void BodyOnDevice<Real>::find_radius(Real* q, double t) {
  if constexpr (std::is_same_v<Real, double>) {
    if (!radius_) return;
    if (is_driven() && !radius_->is_constant()) set_times({&t, 1});
    BodyStep<double> step = step_;
    step.q = q;
    found_radius_ = radius_->at(step);
  }
}

template <class Real>
void BodyOnDevice<Real>::prepare(double h) {
  if (newton_) newton_->prepare(h / method_.iterated.substeps);
  if (!radius_) return;
  std::vector<StabilizedStage<double>>& stages = method_.by_radius.stages;
  method_.by_radius.choose(h, found_radius_, stages);
  method_.nodes.clear();
  for (const StabilizedStage<double>& stage : stages) method_.nodes.push_back(stage.node);
}

template <class Real>
double BodyOnDevice<Real>::longest_step() const {
  return radius_ ? method_.by_radius.longest_step(found_radius_) : std::numeric_limits<double>::infinity();
}

template <class Real>
std::int64_t BodyOnDevice<Real>::steps_at_once() const {
  return radius_ && (is_driven() || !radius_->is_constant()) ? 1 : most_steps;
}

template <class Real>
void BodyOnDevice<Real>::count_steps(std::int64_t steps) {
  counted_.steps += steps;
  counted_.evaluations += steps * method_.evaluations();
}

template <class Real>
template <class Iterations>
void BodyOnDevice<Real>::advance_by(const Iterations& iterations, double h, std::int64_t count) {
  if constexpr (std::is_same_v<Real, double>)
    run(count, [&](BodyStep<double> step, std::vector<DeviceProgram>& programs) {
      const std::int32_t substeps = method_.iterated.substeps;
      double* const end = step.q_next;
      for (std::int32_t s = 0; s < substeps; ++s) {
        step.q_next = s + 1 == substeps ? end : stage_q_[s % 2];
        iterations.append(step, h / substeps, programs);
        step.q = step.q_next, step.v = step.v_next;
        ++step.evaluation;
      }
    });
}

template <class Real>
void BodyOnDevice<Real>::advance(double h, std::int64_t count) {
  step_.h = static_cast<Real>(h);
  step_.half = step_.h / 2;
  count_steps(count);
  const auto moves = [](Move move) {
    return [move](BodyStep<Real> step, std::vector<DeviceProgram>& programs) {
      step.move = move;
      append_step(step, programs);
    };
  };
  switch (method_.kind) {
    case DeviceMethod::Kind::symplectic_euler:
      return run(count, moves(Move::symplectic_euler));
    case DeviceMethod::Kind::kicks: {
      const DeviceProgram first{FirstKick<Real>{step_}};
      device_.run({&first, 1}, 1, {});
      std::swap(step_.q, step_.q_next);
      run(count - 1, moves(Move::kick_drift));
      return run(1, moves(Move::kick));
    }
    case DeviceMethod::Kind::runge_kutta:
    case DeviceMethod::Kind::stabilised:
      return run(count, [this](const BodyStep<Real>& step, std::vector<DeviceProgram>& programs) {
        append_stages(step, programs);
      });
    case DeviceMethod::Kind::newton:
      return advance_by(*newton_, h, count);
    case DeviceMethod::Kind::constraints:
      return advance_by(*constraints_, h, count);
    case DeviceMethod::Kind::points:
      return advance_by(*points_, h, count);
  }
}

template <class Real>
bool BodyOnDevice<Real>::left() {
  std::int32_t found = 0;
  device_.read(&found, step_.left, sizeof found);
  const std::int32_t none = 0;
  device_.write(step_.left, &none, sizeof none);
  return found != 0;
}

template <class Real>
void BodyOnDevice<Real>::keep() {
  device_.copy(kept_.q, step_.q, displacements());
  device_.copy(kept_.v, step_.v, velocities());
  device_.copy(kept_.a, step_.a, velocities());
  kept_counts_ = counted_;
  if (newton_) newton_->keep();
}

template <class Real>
void BodyOnDevice<Real>::go_back() {
  device_.copy(step_.q, kept_.q, displacements());
  device_.copy(step_.v, kept_.v, velocities());
  device_.copy(step_.a, kept_.a, velocities());
  counted_ = kept_counts_;
  if (newton_) newton_->go_back();
}

template <class Real>
double BodyOnDevice<Real>::evaluations_of_a_step() const {
  return static_cast<double>(counted_.evaluations) /
         static_cast<double>(std::max<std::int64_t>(1, counted_.steps));
}

// Of tools: the look at the box around each triangle. Samples near a tool are not counted, how many there are
// changes from step to step.
template <class Real>
double BodyOnDevice<Real>::flops() const {
  constexpr std::array<double, tet_laws> of_tetrahedron{210, 140, 265, 640};
  return (newton_ ? newton_->flops() : 0) + (constraints_ ? constraints_->flops() : 0) +
         (points_ ? points_->flops() : 0) + (radius_ ? radius_->flops() : 0) +
         step_.bodies * evaluations_of_a_step() *
             ((is_of_ten_nodes() ? 2020 : of_tetrahedron[static_cast<std::size_t>(step_.body.law)]) *
                  step_.body.tets +
              79.0 * step_.body.pressures.tets + 57.0 * step_.body.fibres + 31.0 * step_.body.springs +
              24.0 * step_.body.dampers + 101.0 * step_.body.triangles + 18.0 * step_.body.tools.contacts +
              10.0 * 3 * step_.body.free + 6.0 * step_.body.damps);
}

template <class Real>
double BodyOnDevice<Real>::bytes_of_pressures() const {
  if (step_.body.elements != PatchElements::of_pressures) return 0;
  const double tets = step_.body.pressures.tets, averages = static_cast<double>(patches_.average.size());
  return (sizeof(BodyTetrahedron) + 10 * sizeof(Real) + 4 * sizeof(std::int32_t)) * tets +
         (sizeof(PatchAverages) + sizeof(Real)) * static_cast<double>(step_.body.tets) +
         (2 * sizeof(Real) + 2 * sizeof(std::int32_t)) * averages + 5 * sizeof(Real) * tets * step_.bodies;
}

template <class Real>
double BodyOnDevice<Real>::bytes() const {
  constexpr double number = sizeof(Real), number_and_place = 3 * number + 4;
  double slopes = 0;  // that are read again; of stabilised methods two stages, y and its slope
  for (const std::vector<long double>& row : method_.rows)
    for (const long double weight : row) slopes += weight != 0 ? 2 : 0;
  if (radius_) slopes = 6 * evaluations_of_a_step();
  return (newton_ ? newton_->bytes() : 0) + (constraints_ ? constraints_->bytes() : 0) +
         (points_ ? points_->bytes() : 0) + (radius_ ? radius_->bytes() : 0) +
         evaluations_of_a_step() *
             (static_cast<double>(is_of_ten_nodes() ? sizeof(PatchTenNodes) + 126 * sizeof(Real)
                                                    : sizeof(PatchCorners) + 11 * sizeof(Real)) *
                  step_.body.tets +
              bytes_of_pressures() +
              static_cast<double>(sizeof(PatchCorners) + 9 * sizeof(Real)) * step_.body.fibres +
              static_cast<double>(sizeof(PatchSpring) + 2 * sizeof(Real)) * step_.body.springs +
              static_cast<double>(sizeof(PatchSpring) + sizeof(Real)) * step_.body.dampers +
              static_cast<double>(sizeof(PatchTriangle) + 5 * sizeof(Real)) * step_.body.triangles +
              static_cast<double>(sizeof(PatchContact<Real>)) * step_.body.tools.contacts +
              number_and_place * step_.body.damps +
              number_and_place * static_cast<double>(patches_.rim.size()) +
              (3 * (1 + 4.0 * step_.bodies) + 2) * number * step_.body.free) +
         slopes * number * 3 * step_.body.free * step_.bodies;
}

template class BodyOnDevice<double>;
template class BodyOnDevice<float>;

}  // namespace hmax
