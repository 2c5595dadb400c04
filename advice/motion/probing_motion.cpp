#include "advice/motion/probing_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "bench/timing/reference.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/free_parts.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "integrators/linear/sparse_solver.hpp"
#include "limits/linearised_problem.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// Of a load that comes and goes.
struct Course {
  double rise, hold, after;  ///< [s]
};

/// Frames of a second would see nothing of a load that has gone within half of one; it still comes as fast,
/// and so makes the body vibrate.
Course course_of(double frame) {
  const double some_frames = std::max(0.2, 4 * frame);
  return {0.1, some_frames, some_frames};
}

/// The largest displacement K^-1 f [m]; 0 where K has no inverse. Where supports leave rigid motions, K has
/// none: f then acts beside the inertia of these, and what it deforms counts alone.
double linear_displacement(const TissueBody& body, TissueBody::DofMatrix K, Eigen::VectorXd f) {
  constexpr double little = 1e-6;
  const Eigen::MatrixXd rigid = free_motions(body);
  if (rigid.cols() > 0) {
    f -= body.mass().cwiseProduct(rigid * (rigid.transpose() * f));
    const double shift = little * K.diagonal().cwiseAbs().mean();
    for (Eigen::Index i = 0; i < K.rows(); ++i) K.coeffRef(i, i) += shift;
  }
  SparseSolver<double> solver;
  solver.set({.by = LinearSolve::By::direct});
  if (!solver.factor(K)) return 0;
  solver.solve(f);
  if (rigid.cols() > 0) f -= rigid * (rigid.transpose() * body.mass().cwiseProduct(f));
  return largest_displacement(f);
}

/// The forces times this move the body by 2 % of its size, by its stiffness at `q`.
double force_for_2_percent(const Problem& pressed, const Eigen::VectorXd& q) {
  const TissueBody& body = *pressed.body;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.dofs());
  const Problem free = with_settings(pressed, [](TissueSettings& settings) { settings.forces.clear(); });
  Eigen::VectorXd with_force(body.dofs()), without_force(body.dofs());
  body.force(0, q, zero, with_force);
  free.body->force(0, q, zero, without_force);
  TissueBody::DofMatrix K;
  body.stiffness(0, q, zero, K);
  const double given = linear_displacement(body, std::move(K), with_force - without_force);
  return given > 0 && std::isfinite(given) ? 0.02 * diagonal_of(body.mesh()) / given : 1;
}

bool is_loose(const TissueBody& body) { return !loose_dofs(body).empty(); }

/// Of some points the one furthest from a place.
TetMesh::Index furthest(const TetMesh& mesh, const std::vector<TetMesh::Index>& of,
                        const Eigen::Vector3d& place) {
  return *std::ranges::max_element(of, {},
                                   [&](TetMesh::Index i) { return (mesh.points.col(i) - place).norm(); });
}

/// Of some points those near one of them.
std::vector<TetMesh::Index> around(const TetMesh& mesh, const std::vector<TetMesh::Index>& of,
                                   TetMesh::Index tip) {
  const double radius = 0.15 * diagonal_of(mesh);
  std::vector<TetMesh::Index> near;
  for (const TetMesh::Index i : of)
    if ((mesh.points.col(i) - mesh.points.col(tip)).norm() <= radius) near.push_back(i);
  return near;
}

/// far_press(). A part that nothing holds would fly away: it is pulled at both ends, along the line between
/// them, which neither moves nor turns it.
std::vector<PressingForce> test_forces(const TissueBody& body) {
  const TetMesh& mesh = body.mesh();
  PressingForce near = far_press(body);
  for (const std::vector<Eigen::Index>& part : loose_dofs(body)) {
    std::vector<TetMesh::Index> points;
    for (std::size_t i = 0; i < part.size(); i += 3)
      points.push_back(body.free_points()[static_cast<std::size_t>(part[i] / 3)]);
    if (std::ranges::find(points, near.points.front()) == points.end()) continue;
    const auto surface = surface_of(mesh).points;
    std::erase_if(points, [&](TetMesh::Index i) { return !std::ranges::binary_search(surface, i); });
    const auto middle = [&](const PressingForce& force) -> Eigen::Vector3d {
      return mesh.points(Eigen::all, force.points).rowwise().mean();
    };
    const TetMesh::Index tip = furthest(mesh, points, middle(near));
    PressingForce far{.points = around(mesh, points, tip)};
    if (std::ranges::find(near.points, tip) != near.points.end()) {  // a fragment as small as what is pressed
      near.points = {furthest(mesh, points, mesh.points.col(tip))};
      far.points = {tip};
    }
    far.force = (middle(far) - middle(near)).normalized();
    near.force = -far.force;
    return {near, far};
  }
  return {near};
}

/// Afterwards the forces are 0, and not a sum that cancels but for rounding: beside that noise a body at rest
/// has no equations that Newton's method can solve to its tolerance.
void come_and_go(std::vector<PressingForce>& forces, const Course& course) {
  for (PressingForce& force : forces)
    force.profile = {
        .kind = TimeProfile::Kind::ramp, .start = 0, .rise = course.rise, .fall = course.rise + course.hold};
}

/// The searches for an equilibrium of a large body, each with a factor whose cost grows like the square of
/// the degrees of freedom, have fewer iterations, and none is begun with a load under which they are likely
/// to fail: a smaller one serves as well.
bool is_large(const TissueBody& body) { return body.dofs() > 5000; }

StaticSettings settings_for(const TissueBody& body, double tolerance) {
  StaticSettings settings{.tolerance = tolerance};
  if (!is_large(body)) return settings;
  settings.iterations = 50;
  settings.load_steps = 1;
  return settings;
}

/// The first of 1, 1/2, ..., 1/64 that is tried: of a large body one that would move it by at most 2 % of its
/// size, if its stiffness stayed that at rest.
double first_share(const Problem& problem) {
  const TissueBody& body = *problem.body;
  if (!is_large(body)) return 1;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.dofs());
  Eigen::VectorXd f(body.dofs());
  TissueBody::DofMatrix K;
  body.force(0, zero, zero, f);
  body.stiffness(0, zero, zero, K);
  const double most = 0.02 * diagonal_of(body.mesh()),
               moved = linear_displacement(body, std::move(K), std::move(f));
  double share = 1;
  while (share > 1.0 / 64 && share * moved > most) share /= 2;
  return share;
}

std::string_view words_of_share(const TissueBody& body) {
  return is_large(body) ? "under which it has an equilibrium"
                        : "the most of 1, 1/2, 1/4, ... with an equilibrium";
}

/// The largest share of the load, 1, 1/2, ..., 1/64, that has an equilibrium; nothing where none has one.
std::optional<double> share_with_equilibrium(const Problem& problem, const Watcher& watcher) {
  const StaticSettings settings = settings_for(*problem.body, 1e-6);
  for (double share = first_share(problem); share >= 1.0 / 64; share /= 2) {
    if (watcher) watcher();
    if (found_equilibrium(problem, share, settings, [] { return 0.0; }).converged) return share;
  }
  return std::nullopt;
}

/// The share of its forces that a body is probed with, and what is said of it.
std::pair<double, std::string> probing_share(const Problem& problem, const Watcher& watcher) {
  if (const auto share = share_with_equilibrium(problem, watcher))
    return {*share, *share == 1
                        ? "the load"
                        : fmt::format("{:.3g} of the load, {}", *share, words_of_share(*problem.body))};
  const double share = force_for_2_percent(problem, Eigen::VectorXd::Zero(problem.body->dofs()));
  if (is_loose(*problem.body))
    return {std::min(share, 1.0),
            fmt::format(
                "{}; nothing holds the body, and the load may carry it away",
                share < 1 ? fmt::format("{:.3g} of the load, which deforms the body by about 2 % of its size",
                                        share)
                          : "the load")};
  return {share,
          fmt::format("{:.3g} of the load, which moves the body by about 2 % of its size; 1/64 of it has no "
                      "equilibrium",
                      share)};
}

ProbingMotion of_body(const Problem& problem, const Watcher& watcher, double frame) {
  const TissueBody& body = *problem.body;
  if (has_moving_load(problem)) {
    const double t_end = end_of_motion(problem);
    return {.problem = problem, .t_end = t_end, .words = "its own load"};
  }
  const RestingBody resting = resting_under_gravity(problem, watcher);
  TissueSettings settings = settings_of(resting.problem);
  std::string words;
  double share = 1;
  if (settings.forces.empty()) {
    settings.forces = test_forces(body);
    const double newtons =
        force_for_2_percent(with_settings(resting.problem, settings), resting.problem.y0.head(body.dofs()));
    for (PressingForce& force : settings.forces) force.force *= newtons;
    words = fmt::format("a {} of {:.3g} N at {}{}", settings.forces.size() == 1 ? "press" : "pull", newtons,
                        settings.forces.size() == 1 ? "the far end" : "both ends", resting.words);
  } else {
    std::tie(share, words) = probing_share(problem, watcher);
    for (PressingForce& force : settings.forces) force.force *= share;
  }
  const Course course = course_of(frame);
  come_and_go(settings.forces, course);
  const double t_end = course.rise + course.hold + course.rise + course.after;
  return {.problem = with_settings(resting.problem, std::move(settings)),
          .t_end = t_end,
          .words = fmt::format("{}; it rises within {:.3g} s, stays for {:.3g} s and falls within {:.3g} s",
                               words, course.rise, course.hold, course.rise),
          .load_share = share,
          .gravity_share = resting.share};
}

/// The largest distance of a point between two states of a body.
double distance(const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Ref<const Eigen::VectorXd>& b) {
  const Eigen::VectorXd difference = a - b;
  return largest_displacement(difference.head(difference.size() / 2));
}

/// States of a run, and its largest excursion from the start, between them too.
struct Sampled {
  std::vector<Eigen::VectorXd> states;
  double reach = 0;
};

/// How many steps lie between two looks at a motion: a whole part of those between two instants, 20 ms at
/// most.
std::int64_t steps_between_looks(std::int64_t steps, double h) {
  constexpr double longest = 0.02;
  std::int64_t few = std::clamp<std::int64_t>(std::llround(std::floor(longest / h * (1 + 1e-9))), 1, steps);
  while (steps % few != 0) --few;
  return few;
}

/// The state at each of some instants, by a method at h; nothing where a step is not solved.
/// @param at  multiples of the second one, which is one of h
std::optional<Sampled> sampled(const ProbingMotion& motion, const Method& method, double h,
                               const std::vector<double>& at, const Watcher& watcher) {
  Sampled run;
  std::vector<Eigen::VectorXd>& states = run.states;
  const std::int64_t looks = at.size() > 1 ? steps_between_looks(std::llround(at[1] / h), h) : 1,
                     seen_every = method.device ? looks : 1;
  const RunSpec spec{.t_end = motion.t_end, .h = h, .seen_every = seen_every, .max_steps = 100'000'000};
  std::int64_t step = -seen_every;
  const RunRecord record =
      method.bind(motion.problem).run(spec, [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
        if (watcher) watcher();
        step += seen_every;
        if (states.size() < at.size() && t >= at[states.size()] - 0.25 * h) states.emplace_back(y);
        if (step % looks == 0 && t <= at.back() + 0.25 * h)
          run.reach = std::max(run.reach, distance(y, states.front()));
      });
  if (record.outcome != Outcome::reached_end || states.size() != at.size()) return std::nullopt;
  return run;
}

/// What rounding alone moves is no motion: errors relative to it are around one at every step.
/// @throws InputError  where the problem does not move further
void require_motion(const Problem& problem, double scale) {
  // Equilibria of bodies are found to 1e-10.
  const double rounding = problem.body ? 1e-8 * largest_displacement(problem.y0.head(problem.y0.size() / 2))
                                       : 1e-10 * problem.y0.cwiseAbs().maxCoeff();
  if (!(scale > rounding))
    throw InputError(fmt::format(
        "{} stays at its initial state, and steps are judged by a motion; give another {}", problem.id,
        problem.body ? "load, or --motion with forces that are not 0" : "start with --y0"));
}

/// What integrates the reference of a body, from which step on, which divides a frame [s], and how often that
/// is halved at most.
struct ReferenceMethod {
  const char* method;
  double h;
  int halvings;
};

/// In the order in which they are tried. Central differences near their limit, of one force a step, where few
/// halvings suffice; then rk4 from half of its limit. Where explicit steps are much shorter than those that
/// simulators take, newmark from one of those: its step takes as long as hundreds of evaluations of the force
/// of a body.
std::vector<ReferenceMethod> reference_methods(double frame, const ExplicitLimits& limits) {
  constexpr double longest = 0.01, most_explicit_steps = 200;
  constexpr int few = 3, most = 12;
  const auto part_of_frame = [&](double h) { return frame / std::ceil(frame / h); };
  std::vector<ReferenceMethod> methods;
  const auto add = [&](const char* method, double h, int halvings) {
    if (h >= longest / most_explicit_steps)
      methods.push_back({method, part_of_frame(std::min(longest, h)), halvings});
  };
  add("central_difference", 0.8 * limits.central, few);
  add("rk4", limits.rk4 / 2, most);
  if (methods.empty() || methods.back().halvings < most)
    methods.push_back({"newmark", part_of_frame(longest), most});
  return methods;
}

/// Fills states, scale and bound of `reference`.
/// @returns whether the last halving changes little enough; false as soon as the order of the method tells
/// that it needs more of them than `by` has
bool halve_until_steady(const ProbingMotion& motion, const ReferenceMethod& by, const Method& method,
                        double tolerance, ReferenceMotion& reference, const Watcher& watcher) {
  const double goal = tolerance / 10;
  const int order = method.order;
  std::optional<Sampled> coarse;
  double h = by.h;
  for (int halving = 0; halving <= by.halvings; ++halving, h /= 2) {
    auto fine = sampled(motion, method, h, reference.t, watcher);
    if (fine && coarse) {
      reference.scale = fine->reach;
      require_motion(motion.problem, reference.scale);
      double change = 0;
      for (std::size_t i = 0; i < fine->states.size(); ++i)
        change = std::max(change, distance(fine->states[i], coarse->states[i]));
      reference.error_bound = reference.scale > 0 ? change / reference.scale : 0;
      if (reference.error_bound <= goal) {
        reference.y = std::move(fine->states);
        return true;
      }
      if (std::log2(reference.error_bound / goal) / order > by.halvings - halving) return false;
    }
    coarse = std::move(fine);
  }
  return false;
}

/// @throws InputError  where no method is steady
ReferenceMotion steady_reference(const ProbingMotion& motion, double frame, double tolerance,
                                 const ExplicitLimits& limits, ReferenceMotion reference,
                                 const Watcher& watcher, const FindMethod& find) {
  const std::vector<ReferenceMethod> methods = reference_methods(frame, limits);
  for (const ReferenceMethod& by : methods)
    if (halve_until_steady(motion, by, find(by.method), tolerance, reference, watcher)) return reference;
  throw InputError(fmt::format(
      "no reference of {} to {:.2g} is found: {} still changes by {:.2g} where its step is halved; give a larger "
      "--tolerance, a smaller load or a model that holds it",
      motion.problem.id, tolerance, methods.back().method, reference.error_bound));
}

}  // namespace

PressingForce far_press(const TissueBody& body) {
  const TetMesh& mesh = body.mesh();
  Eigen::Vector3d held = mesh.points.rowwise().mean();
  std::vector<TetMesh::Index> supported;
  for (const Support& support : body.settings().supports)
    supported.insert(supported.end(), support.points.begin(), support.points.end());
  for (const ElasticSupport& support : body.settings().elastic_supports)
    supported.insert(supported.end(), support.points.begin(), support.points.end());
  if (!supported.empty()) held = mesh.points(Eigen::all, supported).rowwise().mean();
  const auto surface = surface_of(mesh).points;
  const TetMesh::Index tip = furthest(mesh, surface, held);
  return {.points = around(mesh, surface, tip), .force = (held - mesh.points.col(tip)).normalized()};
}

RestingBody resting_under_gravity(const Problem& problem, const Watcher& watcher) {
  const TissueSettings& settings = settings_of(problem);
  if (settings.gravity.norm() == 0) return {problem, ""};
  TissueSettings weighted = settings, alone = settings;
  alone.forces.clear();
  for (double share = first_share(with_settings(problem, alone)); share >= 1.0 / 64; share /= 2) {
    if (watcher) watcher();
    weighted.gravity = alone.gravity = share * settings.gravity;
    const StaticSolution resting = found_equilibrium(with_settings(problem, alone), 1,
                                                     settings_for(*problem.body, 1e-10), [] { return 0.0; });
    if (!resting.converged) continue;
    RestingBody found{
        share == 1 ? problem : with_settings(problem, std::move(weighted)),
        share == 1 ? " beside gravity"
                   : fmt::format(" beside {:.3g} of gravity, {}", share, words_of_share(*problem.body)),
        share};
    found.problem.y0.head(resting.q.size()) = resting.q;
    return found;
  }
  weighted.gravity.setZero();
  return {with_settings(problem, std::move(weighted)),
          " without gravity, under which there is no equilibrium", 0};
}

ProbingMotion probing_motion(const Problem& problem, const Watcher& watcher, double frame) {
  if (problem.body) return of_body(problem, watcher, frame);
  return {.problem = problem, .t_end = problem.t_end, .words = "its own motion"};
}

ProbingMotion other_motion(const ProbingMotion& motion, double t_end, double slowest) {
  ProbingMotion other = motion;
  other.t_end = t_end;
  if (!motion.problem.body) {
    other.problem.y0 /= 2;
    other.words = "its own motion from half of its initial state";
    return other;
  }
  const TissueBody& body = *motion.problem.body;
  TissueSettings settings = body.settings();
  const bool loose = is_loose(body);
  if (loose) {
    settings.forces = test_forces(body);
  } else {
    PressingForce press = settings.forces.empty() ? far_press(body) : settings.forces.front();
    const Eigen::Vector3d along = press.force.normalized(), across = along.unitOrthogonal();
    press.force = across;
    press.profile = {};
    settings.forces = {press};
  }
  const double newtons =
      0.5 * force_for_2_percent(with_settings(motion.problem, settings), motion.problem.y0.head(body.dofs()));
  const double omega = slowest > 0 ? slowest / 4 : 1;
  for (PressingForce& force : settings.forces) {
    force.force *= newtons;
    force.profile = {.kind = TimeProfile::Kind::sine, .omega = omega};
  }
  other.words = fmt::format("a force of {:.3g} N {}, back and forth every {:.3g} s", newtons,
                            loose ? "along the body" : "in another direction", 2 * std::numbers::pi / omega);
  other.problem = with_settings(motion.problem, std::move(settings));
  other.problem.y0 = motion.problem.y0;
  return other;
}

ReferenceMotion reference_motion(const ProbingMotion& motion, double frame, double tolerance,
                                 const Watcher& watcher, const ExplicitLimits& limits,
                                 const FindMethod& find) {
  constexpr double most_instants = 50;
  const double frames = std::max(1.0, std::floor(motion.t_end / frame * (1 + 1e-12)));
  const double stride = std::ceil(frames / most_instants);
  ReferenceMotion reference;
  for (double i = 0; i <= frames; i += stride) reference.t.push_back(i * frame);
  if (motion.problem.body)
    return steady_reference(motion, frame, tolerance, limits, std::move(reference), watcher, find);
  const Reference exact = make_reference(motion.problem, motion.t_end, watcher);
  reference.ranges = Eigen::VectorXd::Zero(motion.problem.y0.size());
  // Few instants may all be alike, of a period: the ranges are those of at least so many as there are
  // usually.
  const double looks = std::ceil(most_instants / frames);
  for (const double t : reference.t) {
    reference.y.push_back(exact.at(std::min(t, exact.valid_until)));
    for (double look = 0; look < looks; ++look) {
      const Eigen::VectorXd y =
          look == 0 ? reference.y.back() : exact.at(std::min(t + look / looks * frame, exact.valid_until));
      reference.ranges = reference.ranges.cwiseMax((y - reference.y.front()).cwiseAbs());
    }
  }
  reference.scale = reference.ranges.maxCoeff();
  require_motion(motion.problem, reference.scale);
  reference.error_bound = exact.error_bound / reference.scale;
  return reference;
}

double scale_of_state(const ReferenceMotion& reference, Eigen::Index i) {
  const bool moves = i < reference.ranges.size() && reference.ranges[i] > 1e-9 * reference.scale;
  return moves ? reference.ranges[i] : reference.scale;
}

double relative_error(const ProbingMotion& motion, const ReferenceMotion& reference, std::size_t instant,
                      const Eigen::Ref<const Eigen::VectorXd>& y) {
  if (motion.problem.body) {
    const double away = distance(y, reference.y[instant]);
    return reference.scale > 0 ? away / reference.scale : away;
  }
  double largest = 0;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const double away = std::abs(y[i] - reference.y[instant][i]);
    if (std::isnan(away)) return away;
    largest = std::max(largest, away / std::max(scale_of_state(reference, i), 1e-300));
  }
  return largest;
}

}  // namespace hmax
