#include "studies/thigh/local_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <Eigen/SparseCholesky>

#include "catalogue/methods/catalogue.hpp"
#include "studies/thigh/thigh_motion.hpp"

namespace hmax {

namespace {

constexpr double tick = 1e-3, frame = 1e-2;  // of hand and tissue [s]

/// The tissue at each `every` seconds.
std::vector<Eigen::VectorXd> tissue(const Thigh& thigh, const HapticContact& contact, const char* method,
                                    RunSpec spec) {
  // The probe pulls the point with k (x(t) - u).
  const Eigen::VectorXd springs = contact.stiffness * Eigen::VectorXd::Unit(thigh.points(), contact.point);
  const Problem problem = driven_thigh(thigh,
                                       {.mass = contact.mass,
                                        .damping = contact.damping,
                                        .force = springs,
                                        .share = [&](double t) { return contact.position(t); },
                                        .springs = springs},
                                       contact.t_end);
  spec.t_end = contact.t_end;
  std::vector<Eigen::VectorXd> states;
  find_method(method).bind(problem).run(spec, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
    states.emplace_back(y.head(thigh.points()));
  });
  return states;
}

/// How far the point gives way in a frame for a force on it [m/N].
double compliance(const Thigh& thigh, const HapticContact& contact, const Eigen::VectorXd& u) {
  Eigen::SparseMatrix<double> A = thigh.stiffness(u);
  const double inertia = contact.mass / (frame * frame) + contact.damping * contact.mass / frame;
  for (Eigen::Index i = 0; i < A.rows(); ++i) A.coeffRef(i, i) += inertia;
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(A.rows(), contact.point);
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(A).solve(unit)[contact.point];
}

enum class Between { force_held, tissue_held, local_model };

HapticForce felt(std::string name, const Thigh& thigh, const HapticContact& contact,
                 const std::vector<Eigen::VectorXd>& states, double every, Between between) {
  HapticForce felt{.name = std::move(name), .t = {}, .force = {}};
  const auto ticks = static_cast<std::size_t>(std::lround(contact.t_end / tick)),
             ticks_a_state = static_cast<std::size_t>(std::lround(every / tick));
  double held = 0, local = 0, x_n = 0, u_n = 0;
  for (std::size_t i = 0; i < ticks; ++i) {
    const double t = static_cast<double>(i) * tick, x = contact.position(t);
    if (i % ticks_a_state == 0) {
      const Eigen::VectorXd& u = states.at(i / ticks_a_state);
      u_n = u[contact.point];
      x_n = x;
      held = contact.stiffness * (x_n - u_n);
      if (between == Between::local_model)
        local = contact.stiffness / (1 + contact.stiffness * compliance(thigh, contact, u));
    }
    felt.t.push_back(t);
    felt.force.push_back(between == Between::force_held    ? held
                         : between == Between::tissue_held ? contact.stiffness * (x - u_n)
                                                           : held + local * (x - x_n));
  }
  return felt;
}

void compare(HapticForce& felt, const HapticForce& reference) {
  double squares = 0, scale = 0;
  for (std::size_t i = 0; i < felt.force.size(); ++i) {
    const double error = std::abs(felt.force[i] - reference.force[i]);
    squares += error * error;
    felt.largest = std::max(felt.largest, error);
    scale = std::max(scale, std::abs(reference.force[i]));
    if (i > 0) felt.jump = std::max(felt.jump, std::abs(felt.force[i] - felt.force[i - 1]));
  }
  felt.rms = std::sqrt(squares / static_cast<double>(felt.force.size())) / scale;
  felt.largest /= scale;
}

}  // namespace

double HapticContact::position(double t) const {
  constexpr double rise = 0.3;  // [s]
  if (t < rise) return 0.5 * depth * (1 - std::cos(std::numbers::pi * t / rise));
  return depth + shake * std::sin(2 * std::numbers::pi * frequency * (t - rise));
}

std::vector<HapticForce> haptic_forces(const Thigh& thigh, const HapticContact& contact) {
  if (contact.point < 0 || contact.point >= thigh.points())
    throw std::invalid_argument("the probe touches a point that the thigh does not have");
  const auto exact = tissue(thigh, contact, "dop_853",
                            {.adaptive = true, .rtol = 1e-9, .atol = 1e-12, .every = tick}),
             fast = tissue(thigh, contact, "linearly_implicit_euler", {.h = tick}),
             slow = tissue(thigh, contact, "linearly_implicit_euler", {.h = frame});
  std::vector<HapticForce> all{
      felt("reference, one rate", thigh, contact, exact, tick, Between::force_held),
      felt("tissue at 1 kHz", thigh, contact, fast, tick, Between::force_held),
      felt("tissue at 100 Hz, force held", thigh, contact, slow, frame, Between::force_held),
      felt("tissue at 100 Hz, tissue held", thigh, contact, slow, frame, Between::tissue_held),
      felt("tissue at 100 Hz, local model", thigh, contact, slow, frame, Between::local_model)};
  for (HapticForce& each : all) compare(each, all.front());
  return all;
}

}  // namespace hmax
