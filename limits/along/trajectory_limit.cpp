#include "limits/along/trajectory_limit.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <iterator>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "analysis/dynamics/growth.hpp"
#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "analysis/statics/static_solution.hpp"
#include "catalogue/methods/method.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/inversion.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/model.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "core/parallel_for.hpp"
#include "limits/jacobian_changes.hpp"
#include "limits/kinks.hpp"
#include "limits/modes/mode_curve.hpp"
#include "limits/modes/mode_range.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

std::string four_digits(double value) { return fmt::format("{:.4g}", value); }

/// The modes of a tangent, of large bodies by the ends of its spectrum. Close to rest it commutes with its
/// damping to rounding and is no multiple of it: such damping is taken for general.
ModeSet modes_along(const Problem& problem, OperatingPoint& point) {
  LinearModel& model = point.model;
  if (!problem.body || problem.body->dofs() <= small_enough_for_dense) return mode_set(model, point.is_body);
  ModeSet modes;
  if (set_curve(model, modes, small_enough_for_dense)) return modes;
  if (model.mechanical && model.mechanical->damping == Damping::proportional)
    model.mechanical->damping = Damping::general;
  if (!set_range(model, modes, small_enough_for_dense))
    throw input_error(
        "the stiffness of this body is not symmetric along its path, and all modes of {} degrees of freedom "
        "together are too many; take a smaller mesh, or a load that does not move",
        problem.body->dofs());
  return modes;
}

/// Whether the tangents of two states of one problem are the same, so that their modes are.
bool is_same(const OperatingPoint& a, const OperatingPoint& b) { return !jacobian_differs(a.model, b.model); }

void look(const Watcher& watcher) {
  if (watcher) watcher();
}

/// Traces of J and of J^2: sums of eigenvalues and of their squares, whatever the units of the states.
Eigen::Array2d invariants(const Problem& problem, double t, const Eigen::VectorXd& y) {
  const AnyMatrix J = linear_model(problem, t, y).J();
  return std::visit(
      []<class Matrix>(const Matrix& held) {
        const Matrix transposed = held.transpose();
        return Eigen::Array2d(held.diagonal().sum(), held.cwiseProduct(transposed).sum());
      },
      J);
}

/// Finds the states of a motion that its regular instants pass over: extremes of the invariants of J between
/// them, and both sides of breakpoints.
class Events {
 public:
  /// @param accepted  about how many steps will be shown
  Events(const Problem& problem, const Path& regular, double t_end, std::int64_t accepted)
      : problem_(problem),
        regular_(regular),
        is_exact_(linear_model(problem, regular.at.front(), regular.y.front()).origin ==
                  JacobianOrigin::analytic) {
    // Differences take two evaluations for each state.
    constexpr double most_evaluations = 4e6;
    const double most = most_evaluations / static_cast<double>(2 * problem.y0.size() + 1);
    stride_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(static_cast<double>(accepted) / most));
    set_instants(t_end);
    before_ = seen_at(0);
  }

  /// An accepted step.
  void see(double t, const Eigen::VectorXd& y) {
    for (; next_ < instants_.size() && instants_[next_] <= t; ++next_) {
      const double at = instants_[next_], share = t > last_t_ ? (at - last_t_) / (t - last_t_) : 1;
      if (last_y_.size() > 0) add(at, last_y_ + share * (y - last_y_));
    }
    last_t_ = t;
    last_y_ = y;
    while (window_ + 2 < regular_.at.size() && t >= regular_.at[window_ + 1]) close_window();
    if (++count_ % stride_ != 0) return;
    // Differences across a kink are no Jacobian.
    if (!is_exact_ && !kinks_at(problem_, t, y, y.cwiseAbs().maxCoeff(), KinkPlace::within_reach, 1).empty())
      return;
    try {
      const Sample sample{invariants(problem_, t, y), t, y};
      for (const int i : {0, 1}) widen(i, sample);
    } catch (const InputError&) {  // a Jacobian that is not finite has no modes
    }
  }

  /// The regular path with the states that were found.
  [[nodiscard]] Path merged() {
    close_window();
    std::vector<std::size_t> order(found_.at.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return found_.at[i]; });
    Path path{.note = regular_.note, .tolerances = regular_.tolerances};
    std::size_t k = 0;
    const auto put = [&](double t, const Eigen::VectorXd& y) {
      if (!path.at.empty() && path.at.back() == t) return;
      path.at.push_back(t);
      path.y.push_back(y);
    };
    for (std::size_t i = 0; i < regular_.at.size(); ++i) {
      for (; k < order.size() && found_.at[order[k]] < regular_.at[i]; ++k)
        put(found_.at[order[k]], found_.y[order[k]]);
      put(regular_.at[i], regular_.y[i]);
    }
    return path;
  }

 private:
  struct Extreme {
    double value, t;
    Eigen::VectorXd y;
  };
  struct Sample {
    Eigen::Array2d value;
    double t;
    Eigen::VectorXd y;
  };

  void widen(int i, const Sample& sample) {
    const double value = sample.value[i];
    if (!highest_[i] || value > highest_[i]->value) highest_[i] = Extreme{value, sample.t, sample.y};
    if (!lowest_[i] || value < lowest_[i]->value) lowest_[i] = Extreme{value, sample.t, sample.y};
  }

  void set_instants(double t_end) {
    const auto* system = std::get_if<AnySystem>(&problem_.system);
    if (system == nullptr) return;
    constexpr std::size_t most = 200;
    std::vector<double> jumps = system->breakpoints(0, t_end);
    const std::size_t stride = 1 + jumps.size() / most;
    double last = 0;
    for (std::size_t i = 0; i <= jumps.size(); ++i) {
      const double jump = i < jumps.size() ? jumps[i] : t_end;
      if (i % stride == 0) {
        instants_.push_back((last + jump) / 2);
        const double beside = 1e-9 * (jump - last);
        if (i < jumps.size()) instants_.insert(instants_.end(), {jump - beside, jump, jump + beside});
      }
      last = jump;
    }
    std::ranges::sort(instants_);
  }

  [[nodiscard]] Eigen::Array2d seen_at(std::size_t i) const {
    return invariants(problem_, regular_.at[i], regular_.y[i]);
  }

  void add(double t, const Eigen::VectorXd& y) {
    found_.at.push_back(t);
    found_.y.push_back(y);
  }

  /// Keeps the extremes between two regular instants that lie beyond what is known there.
  void close_window() {
    if (window_ + 1 >= regular_.at.size()) return;
    const Eigen::Array2d after = seen_at(window_ + 1);
    constexpr double beyond = 1e-4;
    for (const int i : {0, 1}) {
      const double low = std::min(before_[i], after[i]), high = std::max(before_[i], after[i]),
                   hair = beyond * std::max(std::abs(low), std::abs(high));
      if (highest_[i] && highest_[i]->value > high + hair) add(highest_[i]->t, highest_[i]->y);
      if (lowest_[i] && lowest_[i]->value < low - hair) add(lowest_[i]->t, lowest_[i]->y);
      highest_[i].reset();
      lowest_[i].reset();
    }
    before_ = after;
    ++window_;
  }

  const Problem& problem_;
  const Path& regular_;
  Path found_;
  std::vector<double> instants_;  ///< that are looked at wherever steps end
  std::size_t next_ = 0, window_ = 0;
  std::int64_t stride_ = 1, count_ = 0;
  double last_t_ = 0;
  Eigen::VectorXd last_y_;
  Eigen::Array2d before_ = Eigen::Array2d::Zero();
  std::array<std::optional<Extreme>, 2> highest_, lowest_;
  bool is_exact_;  ///< the Jacobian is not one of differences
};

/// The size of one state.
MotionSize size_of(const Eigen::Ref<const Eigen::VectorXd>& y, bool mechanical) {
  if (!mechanical) return {.positions = y.norm(), .velocities = 0};
  const Eigen::Index n = y.size() / 2;
  return {.positions = y.head(n).norm(), .velocities = y.tail(n).norm()};
}

}  // namespace

std::optional<Path> path_of_matrices(const Problem& problem, double t_end) {
  if (!problem.matrices) return std::nullopt;
  if (!(t_end > 0 && std::isfinite(t_end)))
    throw input_error("the end time is {} s but must be positive and finite; give another", to_text(t_end));
  Path path{.at = {0}};
  const std::vector<double> times = times_of_matrices(problem);
  std::ranges::copy_if(times, std::back_inserter(path.at), [&](double t) { return t > 0 && t < t_end; });
  if (!times.empty()) path.at.push_back(t_end);
  path.y.assign(path.at.size(), Eigen::VectorXd::Zero(problem.y0.size()));
  return path;
}

Path motion_path(const Problem& problem, double t_end, int points, const Watcher& watcher) {
  if (auto path = path_of_matrices(problem, t_end)) return *std::move(path);
  struct Inverted {};
  Path path;
  const auto keep = [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    if (const auto inversion = inversion_at(problem, t, y)) {
      path.note = fmt::format(
          "tetrahedron {} is inverted by t = {} s of the motion: what moves on from there is no body, and "
          "no limit is looked for beyond {} s",
          inversion->tetrahedron, four_digits(t), four_digits(path.at.back()));
      throw Inverted{};
    }
    path.at.push_back(t);
    path.y.emplace_back(y);
  };
  path.tolerances = motion_tolerances(problem, t_end, watcher);
  std::int64_t accepted = 0;
  try {
    accepted = show_motion(problem, path.tolerances, t_end, points, watcher, keep);
  } catch (const Inverted&) {
  }
  if (problem.body || linearity_of(problem) == Linearity::linear) return path;
  Events events(problem, path, t_end, accepted);
  show_motion(problem, path.tolerances, t_end, 0, watcher,
              [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) { events.see(t, y); });
  return events.merged();
}

MotionSize size_of_motion(const Problem& problem, double t_end, const Watcher& watcher) {
  constexpr std::size_t most_numbers = 8'000'000, most_states = 100'000;
  const std::size_t most =
      std::clamp<std::size_t>(most_numbers / static_cast<std::size_t>(problem.y0.size() + 1), 2, most_states);
  MotionSize size;
  std::size_t stride = 1, count = 0;
  const MotionTolerances tolerances = motion_tolerances(problem, t_end, watcher);
  show_motion(problem, tolerances, t_end, 0, watcher,
              [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
                const MotionSize here = size_of(y, is_second_order(problem));
                size.positions = std::max(size.positions, here.positions);
                size.velocities = std::max(size.velocities, here.velocities);
                if (t < t_end && count++ % stride != 0) return;
                size.t.push_back(t);
                size.y.emplace_back(y);
                if (size.t.size() < most) return;
                // Every second state, from now on too.
                stride *= 2;
                for (std::size_t i = 0; 2 * i < size.t.size(); ++i) {
                  size.t[i] = size.t[2 * i];
                  size.y[i].swap(size.y[2 * i]);
                }
                size.t.resize((size.t.size() + 1) / 2);
                size.y.resize(size.t.size());
              });
  return size;
}

Path load_path(const Problem& problem, int points, const Watcher& watcher) {
  const TissueBody& body = require_body(problem, "so no load is brought on; look along its motion");
  if (has_moving_load(problem))
    throw input_error(
        "the load of {} changes with time; take gravity, press or pull, or look along "
        "the motion",
        problem.id);
  if (is_at_rest(body))
    throw input_error(
        "nothing loads {}, so no load can grow; give it one with --set, g of gravity or force of press "
        "and pull, or leave --along load out",
        problem.id);
  Path path;
  for (int i = 0; i <= points; ++i) {
    look(watcher);
    const double share = static_cast<double>(i) / points;
    Eigen::VectorXd y = problem.y0;
    if (i > 0) {
      const StaticSolution equilibrium = solve_static(
          static_model(problem, share),
          {.load_steps = 1 + static_cast<int>(4 * share), .leave_saddles = false}, [] { return 0.0; });
      if (!equilibrium.converged) {
        path.note =
            fmt::format("no equilibrium was found under more than {} of the load: under {} of it {}",
                        four_digits(path.at.back()), four_digits(share), cause_of(problem, equilibrium));
        break;
      }
      y.head(equilibrium.q.size()) = equilibrium.q;
    }
    path.at.push_back(share);
    path.y.push_back(std::move(y));
  }
  return path;
}

namespace {

/// Puts what holds at one point of a path into the limit along it.
void add_point(TrajectoryLimit& limit, const Prediction& here, const Path& path, std::size_t i) {
  if (here.growing) {
    limit.growing += 1;
    if (std::isnan(limit.grows_from)) limit.grows_from = path.at[i];
  } else if (!here.h_max && limit.note.empty()) {
    limit.note = here.note;
  }
  const double h = here.h_max.value_or(std::numeric_limits<double>::quiet_NaN());
  limit.h_max.push_back(h);
  if (!(h < limit.least || (std::isnan(limit.least) && !std::isnan(h)))) return;
  limit.least = h;
  limit.t_least = path.at[i];
  limit.y_least = path.y[i];
}

/// Of each state, whose tangents are long and all different: the limits of the methods that have one along a
/// path.
/// @returns shape (states, methods)
std::vector<std::vector<Prediction>> predicted_along_body(std::span<const Method> methods,
                                                          const Problem& problem, const Path& path,
                                                          const Watcher& watcher) {
  std::vector<std::vector<Prediction>> rows(path.at.size(), std::vector<Prediction>(methods.size()));
  const auto predict_at = [&](std::size_t i) {
    Linearised near{.point = operating_point(problem, path.at[i], path.y[i])};
    near.modes = modes_along(problem, near.point);
    for (std::size_t k = 0; k < methods.size(); ++k)
      if (methods[k].analysed().amplification && suits(methods[k], problem))
        rows[i][k] = predict(methods[k], near);
  };
  // One factor at a time where they are large, by all threads: several fill the memory.
  if (factors_take_seconds(problem)) {
    for (std::size_t i = 0; i < path.at.size(); ++i) {
      look(watcher);
      predict_at(i);
    }
    return rows;
  }
  std::exception_ptr end;
  std::atomic<bool> ended = false;
  parallel_for(
      path.at.size(), [&](std::size_t i, std::size_t) { predict_at(i); },
      [&](std::size_t) {
        try {
          look(watcher);
        } catch (...) {
          if (!ended.exchange(true)) end = std::current_exception();
        }
      },
      [&] { return ended.load(); });
  if (end) std::rethrow_exception(end);
  return rows;
}

void finish(std::vector<std::optional<TrajectoryLimit>>& limits, const Path& path) {
  for (auto& limit : limits)
    if (limit) limit->growing /= static_cast<double>(path.at.size());
}

}  // namespace

std::vector<std::optional<TrajectoryLimit>> limits_along(std::span<const Method> methods,
                                                         const Problem& problem, const Path& path,
                                                         const Watcher& watcher) {
  std::vector<std::optional<TrajectoryLimit>> limits;
  for (const Method& method : methods) {
    limits.emplace_back();
    if (!method.analysed().amplification || !suits(method, problem)) continue;
    limits.back() = TrajectoryLimit{.t = path.at,
                                    .least = std::numeric_limits<double>::quiet_NaN(),
                                    .y_least = path.y.front(),
                                    .tolerances = path.tolerances};
  }
  if (problem.body) {
    const std::vector<std::vector<Prediction>> rows = predicted_along_body(methods, problem, path, watcher);
    for (std::size_t i = 0; i < path.at.size(); ++i)
      for (std::size_t k = 0; k < methods.size(); ++k)
        if (limits[k]) add_point(*limits[k], rows[i][k], path, i);
    finish(limits, path);
    return limits;
  }
  const bool asks_whether_constant = linearity_of(problem) == Linearity::unknown;
  std::optional<LinearModel> first;
  Linearised near;
  std::vector<Prediction> rows(methods.size());
  for (std::size_t i = 0; i < path.at.size(); ++i) {
    look(watcher);
    OperatingPoint point = operating_point(problem, path.at[i], path.y[i]);
    const bool constant = !asks_whether_constant || !first || !jacobian_differs(*first, point.model);
    if (!first && asks_whether_constant) first = point.model;
    const bool same = i > 0 && is_same(near.point, point);
    if (!same) {
      near = {.point = std::move(point)};
      near.modes = modes_along(problem, near.point);
    }
    for (std::size_t k = 0; k < methods.size(); ++k) {
      if (!limits[k]) continue;
      if (!same) rows[k] = predict(methods[k], near);
      limits[k]->constant = limits[k]->constant && constant;
      add_point(*limits[k], rows[k], path, i);
    }
  }
  finish(limits, path);
  return limits;
}

std::optional<TrajectoryLimit> limit_along(const Method& method, const Problem& problem, double t_end,
                                           int points) {
  if (!method.analysed().amplification || !suits(method, problem)) return std::nullopt;
  return limits_along({&method, 1}, problem, motion_path(problem, t_end, points)).front();
}

namespace {

/// y less the motion at t.
/// @param at  an instant of the motion not after t, which moves on with it
void take_off_motion(const MotionSize& motion, double t, std::size_t& at, Eigen::VectorXd& y) {
  if (motion.t.empty()) return;
  while (at + 1 < motion.t.size() && motion.t[at + 1] <= t) ++at;
  y -= motion.y[at];
  if (at + 1 == motion.t.size()) return;
  const double share = (t - motion.t[at]) / (motion.t[at + 1] - motion.t[at]);
  y -= share * (motion.y[at + 1] - motion.y[at]);
}

/// Whether a motion stays where it begins, but for rounding.
bool rests(const MotionSize& motion) {
  const auto is_start = [&](const Eigen::VectorXd& y) {
    return ((y - motion.y.front()).cwiseAbs().array() <= 1e-9 * y.cwiseAbs().array()).all();
  };
  return !motion.y.empty() && std::ranges::all_of(motion.y, is_start);
}

}  // namespace

double guess_from_start(double along_least, double h_max, double t_end) {
  double guess = t_end / 100;
  for (const double limit : {h_max, along_least})
    if (limit > 0 && std::isfinite(limit)) guess = limit;
  return std::min(guess, t_end / 20);
}

std::optional<StartLimit> limit_from_start(const Method& method, const Problem& problem, double t_end,
                                           double guess, const MotionSize& size, double steps,
                                           const Watcher& watcher) {
  if (!method.fixed_step || !suits(method, problem) || rests(size)) return std::nullopt;
  constexpr double finest = 1e-4, coarsest = 0.02, most_times = 25;
  double low = 0.1 * guess;
  // Runs of t_end / h steps from low to high, one in each stride, take about t_end / (stride low) steps.
  const double stride = std::clamp(t_end / (low * steps), finest, coarsest);
  if (!(t_end / (low * stride) <= most_times * steps)) return std::nullopt;
  const bool mechanical = is_second_order(problem);
  const Runner runner = method.bind(problem);
  Eigen::VectorXd away(problem.y0.size());
  const auto stays = [&](double h) {
    bool inside = true;
    RunSpec spec{.t_end = t_end, .h = h};
    std::size_t at = 0;
    const RunRecord record = runner.run(spec, [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
      look(watcher);
      if (!inside) return;
      away = y;
      take_off_motion(size, t, at, away);
      const MotionSize here = size_of(away, mechanical);
      inside = inside && here.positions <= 3 * size.positions && here.velocities <= 3 * size.velocities;
    });
    return inside && record.outcome == Outcome::reached_end;
  };
  const double farthest = t_end / 10, usual = 100 * guess;
  // Too short a run to tell a stable step from one that had no time to grow.
  if (farthest < 2 * guess) return std::nullopt;
  if (!stays(low)) return std::nullopt;
  double high = low;
  for (;;) {
    high *= 1 + (high < usual ? stride : coarsest);
    if (high > farthest) return StartLimit{infinity, stride};
    if (!stays(high)) break;
    low = high;
  }
  while (high - low > 1e-4 * high) {
    const double middle = (low + high) / 2;
    (stays(middle) ? low : high) = middle;
  }
  return StartLimit{low, stride};
}

}  // namespace hmax
