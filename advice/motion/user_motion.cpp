#include "advice/motion/user_motion.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "core/text/counted.hpp"
#include "problems/tissue/body.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

/// The column of this name, whatever unit stands behind it; null where there is none.
const std::vector<double>* column(const Table& table, std::string_view name) {
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    if (table.columns[i].substr(0, table.columns[i].find(' ')) == name) return &table.values[i];
  return nullptr;
}

void check_times(const std::vector<double>& t, const std::string& file) {
  if (t.size() < 2) throw InputError(fmt::format("{}: a motion needs two lines of numbers or more", file));
  if (t.front() != 0)
    throw InputError(
        fmt::format("{}: the first time is {:.6g} s; let the motion begin at t = 0", file, t.front()));
  for (std::size_t i = 1; i < t.size(); ++i)
    if (!(t[i] > t[i - 1]) || !std::isfinite(t[i]))
      throw InputError(
          fmt::format("{}: the time {:.6g} s follows {:.6g} s; give increasing times", file, t[i], t[i - 1]));
}

}  // namespace

UserMotion read_user_motion(const std::filesystem::path& file) {
  const Table table = read_csv(file);
  const std::string name = file.string();
  const std::vector<double>* t = column(table, "t");
  if (!t)
    throw InputError(fmt::format("{}: there is no column t; write the times in seconds into one", name));
  check_times(*t, name);
  UserMotion motion{.name = name, .t_end = t->back()};
  const auto take = [&](const std::array<const char*, 3>& names) {
    std::size_t found = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::vector<double>* values = column(table, names[axis]);
      if (!values) continue;
      ++found;
      if (!std::ranges::all_of(*values, [](double v) { return std::isfinite(v); }))
        throw InputError(
            fmt::format("{}: the column {} has a value that is not finite; write a number into each line",
                        name, names[axis]));
      motion.along[axis] = std::make_shared<const SampledCurve>(*t, *values);
    }
    return found;
  };
  const std::size_t forces = take({"fx", "fy", "fz"});
  if (forces == 0) motion.kind = UserMotion::Kind::displacements;
  const std::size_t displacements = forces > 0 ? 0 : take({"x", "y", "z"});
  if (forces + displacements == 0)
    throw InputError(
        fmt::format("{}: there is neither fx, fy, fz [N] nor x, y, z [m] beside t; add those columns", name));
  return motion;
}

ProbingMotion probing_motion(const Problem& problem, const UserMotion& user, const Watcher& watcher) {
  const TissueBody& body = require_body(problem, "and --motion acts on its points; leave it out");
  const bool presses = user.kind == UserMotion::Kind::forces;
  if (!presses && user.points.empty())
    throw InputError(fmt::format("{} moves points, but no points are named; add --motion-at", user.name));
  TissueSettings settings = body.settings();
  settings.forces.clear();
  const std::vector<TetMesh::Index> points = user.points.empty() ? far_press(body).points : user.points;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!user.along[axis]) continue;
    const TimeProfile profile{.kind = TimeProfile::Kind::samples, .curve = user.along[axis]};
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis));
    if (presses)
      settings.forces.push_back({.points = points, .force = unit, .shares = {}, .profile = profile});
    else
      settings.supports.push_back({.points = points, .travel = unit, .profile = profile});
  }
  ProbingMotion motion{.problem = told_to_user([&] { return with_settings(problem, settings); }),
                       .t_end = user.t_end,
                       .words = fmt::format("{} of {} on {}", presses ? "the forces" : "the displacements",
                                            user.name, counted(points.size(), "point"))};
  // The state has the size of what moves freely.
  motion.problem.y0.setZero(2 * unknowns_of(motion.problem));
  const RestingBody resting = resting_under_gravity(motion.problem, watcher);
  motion.problem = resting.problem;
  motion.gravity_share = resting.share;
  motion.words += resting.words;
  return motion;
}

}  // namespace hmax
