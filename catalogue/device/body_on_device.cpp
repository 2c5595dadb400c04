#include "catalogue/device/body_on_device.hpp"

#include <array>
#include <utility>

namespace hmax {

namespace {
bool is_damped(const TissueBody& body) { return body.settings().alpha != 0 || body.settings().beta != 0; }
}  // namespace

BodyOnDevice::BodyOnDevice(Device& device, const TissueBody& body, DeviceMethod method)
    : device_(device),
      method_(std::move(method)),
      patches_(body_patches(body, 128, device.facts().shared_memory / sizeof(double))) {
  step_ = {.body = arrays(),
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
           .left = static_cast<std::int32_t*>(device.allocate(sizeof(std::int32_t))),
           .sum = {}};
  kept_ = {numbers(displacements()), numbers(velocities()), numbers(velocities())};
  // Without damping the three methods of kicks are one.
  if (method_.damping != KickDamping::half_step && is_damped(body)) step_.half_v = numbers(velocities());
  if (method_.damping == KickDamping::lumped && is_damped(body)) step_.lumped = there(lumped_damping(body));
  if (method_.kind != DeviceMethod::Kind::runge_kutta) return;
  step_.sum.slopes = numbers(2 * velocities() * method_.rows.size());
  for (double*& q : stage_q_) q = numbers(displacements());
  for (double*& v : stage_v_) v = numbers(velocities());
}

std::vector<double> BodyOnDevice::lumped_damping(const TissueBody& body) const {
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix C;
  body.damping(0, still, still, C);
  const std::size_t free = patches_.mass.size();
  std::vector<double> lumped(3 * free);
  for (Eigen::Index i = 0; i < body.dofs(); ++i)
    lumped[static_cast<std::size_t>(i % 3) * free +
           static_cast<std::size_t>(patches_.order[static_cast<std::size_t>(i / 3)])] =
        C.coeff(i, i) / body.mass()[i];
  return lumped;
}

BodyArrays BodyOnDevice::arrays() {
  const BodyPatches& p = patches_;
  return {.patches = static_cast<std::int32_t>(p.begin.size()) - 1,
          .points = p.points,
          .free = p.free(),
          .tets = static_cast<std::int32_t>(p.mu.size()),
          .springs = static_cast<std::int32_t>(p.ends.size()),
          .begin = there(p.begin),
          .rim = there(p.rim),
          .law = p.law,
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
          .watch = p.watch};
}

template <class T>
const T* BodyOnDevice::there(const std::vector<T>& values) {
  void* const to = device_.allocate(std::max<std::size_t>(1, values.size()) * sizeof(T));
  if (!values.empty()) device_.write(to, values.data(), values.size() * sizeof(T));
  return static_cast<const T*>(to);
}

template <class Use>
void BodyOnDevice::visit(std::vector<double>& q, std::vector<double>& v, const Use& use) const {
  const auto points = static_cast<std::size_t>(patches_.points), free = patches_.mass.size();
  for (std::size_t p = 0; p < free; ++p)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto place = static_cast<std::size_t>(patches_.order[p]);
      use(static_cast<Eigen::Index>(3 * p + i), q[i * points + place], v[i * free + place]);
    }
}

void BodyOnDevice::set(const Eigen::VectorXd& y) {
  std::vector<double> q(3 * static_cast<std::size_t>(patches_.points), 0.0), v(3 * patches_.mass.size());
  visit(q, v, [&](Eigen::Index i, double& to_q, double& to_v) { to_q = y[i], to_v = y[y.size() / 2 + i]; });
  // All of them, since steps write the free points alone.
  for (double* const to : {step_.q, step_.q_next, stage_q_[0], stage_q_[1]})
    if (to) device_.write(to, q.data(), displacements());
  device_.write(step_.v, v.data(), velocities());
  static_cast<void>(left());
}

Eigen::VectorXd BodyOnDevice::get() {
  std::vector<double> q(3 * static_cast<std::size_t>(patches_.points)), v(3 * patches_.mass.size());
  device_.read(q.data(), step_.q, displacements());
  device_.read(v.data(), step_.v, velocities());
  Eigen::VectorXd y(2 * static_cast<Eigen::Index>(v.size()));
  visit(q, v, [&](Eigen::Index i, double& of_q, double& of_v) { y[i] = of_q, y[y.size() / 2 + i] = of_v; });
  return y;
}

template <class Append>
void BodyOnDevice::run(std::int64_t count, const Append& append) {
  const auto swap = [this] {
    std::swap(step_.q, step_.q_next);
    std::swap(step_.v, step_.v_next);
  };
  std::vector<BodyStep> programs;  // of two steps, there and back
  append(step_, programs);
  const std::size_t one = programs.size();
  swap();
  append(step_, programs);
  swap();
  if (count > 1) device_.run(programs, patches_.shared, count / 2);
  if (count % 2 == 0) return;
  device_.run({programs.data(), one}, patches_.shared, 1);
  swap();
}

void BodyOnDevice::start() {
  if (method_.kind == DeviceMethod::Kind::kicks)
    run(1, [](BodyStep step, std::vector<BodyStep>& programs) {
      step.move = Move::start;
      programs.push_back(step);
    });
}

void BodyOnDevice::append_stages(BodyStep step, std::vector<BodyStep>& programs) const {
  const BodyStep whole = step;
  const std::size_t stages = method_.rows.size();
  step.move = Move::stage;
  step.sum.q = whole.q, step.sum.v = whole.v;
  for (std::size_t i = 0; i < stages; ++i) {
    StageSum& sum = step.sum;
    sum.stage = static_cast<std::int32_t>(i);
    sum.is_end = i + 1 == stages;
    sum.terms = 0;
    for (std::size_t j = 0; j <= i; ++j)
      if (const long double weight = method_.rows[i][j]; weight != 0) {
        sum.slope[sum.terms] = static_cast<std::int32_t>(j);
        sum.weight[sum.terms++] = step.h * static_cast<double>(weight);
      }
    step.q_next = sum.is_end ? whole.q_next : stage_q_[i % 2];
    step.v_next = sum.is_end ? whole.v_next : stage_v_[i % 2];
    programs.push_back(step);
    step.q = step.q_next, step.v = step.v_next;
  }
}

void BodyOnDevice::advance(double h, std::int64_t count) {
  step_.h = h;
  step_.half = h / 2;
  const auto moves = [](Move move) {
    return [move](BodyStep step, std::vector<BodyStep>& programs) {
      step.move = move;
      programs.push_back(step);
    };
  };
  switch (method_.kind) {
    case DeviceMethod::Kind::symplectic_euler:
      return run(count, moves(Move::symplectic_euler));
    case DeviceMethod::Kind::kicks:
      device_.begin(step_);
      std::swap(step_.q, step_.q_next);
      run(count - 1, moves(Move::kick_drift));
      return run(1, moves(Move::kick));
    case DeviceMethod::Kind::runge_kutta:
      return run(count, [this](const BodyStep& step, std::vector<BodyStep>& programs) {
        append_stages(step, programs);
      });
  }
}

bool BodyOnDevice::left() {
  std::int32_t found = 0;
  device_.read(&found, step_.left, sizeof found);
  const std::int32_t none = 0;
  device_.write(step_.left, &none, sizeof none);
  return found != 0;
}

void BodyOnDevice::keep() {
  device_.copy(kept_.q, step_.q, displacements());
  device_.copy(kept_.v, step_.v, velocities());
  device_.copy(kept_.a, step_.a, velocities());
}

void BodyOnDevice::go_back() {
  device_.copy(step_.q, kept_.q, displacements());
  device_.copy(step_.v, kept_.v, velocities());
  device_.copy(step_.a, kept_.a, velocities());
}

double BodyOnDevice::flops() const {
  constexpr std::array<double, tet_laws> of_tetrahedron{210, 140, 265};
  return static_cast<double>(method_.evaluations()) *
         (of_tetrahedron[static_cast<std::size_t>(step_.body.law)] * step_.body.tets +
          31.0 * step_.body.springs + 10.0 * 3 * step_.body.free + 6.0 * step_.body.damps);
}

double BodyOnDevice::bytes() const {
  double slopes = 0;  // that are read again
  for (const std::vector<long double>& row : method_.rows)
    for (const long double weight : row) slopes += weight != 0 ? 2 * 8 : 0;
  return static_cast<double>(method_.evaluations()) *
             (static_cast<double>(sizeof(PatchCorners) + 11 * sizeof(double)) * step_.body.tets +
              static_cast<double>(sizeof(PatchSpring) + 2 * sizeof(double)) * step_.body.springs +
              28.0 * step_.body.damps + 28.0 * static_cast<double>(patches_.rim.size()) +
              (3 * 5 + 2) * 8.0 * step_.body.free) +
         slopes * 3 * step_.body.free;
}

}  // namespace hmax
