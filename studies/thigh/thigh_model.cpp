#include "studies/thigh/thigh_model.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <Eigen/SparseCholesky>
#include <fmt/format.h>

namespace hmax {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

// The thigh of which everything is known.
constexpr double arc =
    0.08 * 20 * std::numbers::pi / 180;  // between points around: 20 degrees of a radius of 80 mm
constexpr double spacing = 0.02;         // between points along [m]
constexpr double tension = 25;           // of the skin [N/m]
constexpr double growth = 6;             // e-fold growths of the force over the depth

/// Of soft tissue over the bone [m]; s around, t along the bone, both from -1 to 1.
double tissue_depth(double s, double t) {
  return 0.055 + 0.014 * s - 0.008 * t + 0.006 * std::sin(3 * s) * std::cos(2 * t);
}
double young(double s, double t) { return 8000 * (1 + 0.3 * std::cos(2 * s + 1) + 0.2 * t); }  // [Pa]

void require_valid(const Thigh& thigh, std::span<const double> depths) {
  if (thigh.a.size() != thigh.points() || thigh.b.size() != thigh.points())
    throw std::invalid_argument(
        fmt::format("a thigh of {} points has {} values a and {} values b; give one for each", thigh.points(),
                    thigh.a.size(), thigh.b.size()));
  const auto positive = [](double value) { return value > 0; };  // NaN is not
  bool valid = thigh.a.unaryExpr(positive).all() && thigh.b.unaryExpr(positive).all();
  for (const SkinSpring& spring : thigh.skin) valid = valid && positive(spring.stiffness);
  if (!valid)
    throw std::invalid_argument("a spring of the thigh has a parameter that is not positive; a, b, k > 0");
  double last = 0;
  for (const double depth : depths) {
    if (!(depth > last) || !std::isfinite(depth))
      throw std::invalid_argument(
          fmt::format("a probe at {} m follows one at {} m; give depths that increase from 0", depth, last));
    last = depth;
  }
}

/// Replaces the equations of pressed points by u_p = known, in one pattern.
void hold(Matrix& K, const std::vector<bool>& pressed) {
  for (Eigen::Index j = 0; j < K.outerSize(); ++j)
    for (Matrix::InnerIterator entry(K, j); entry; ++entry) {
      const auto row = static_cast<std::size_t>(entry.row()), column = static_cast<std::size_t>(entry.col());
      if (row == column ? pressed[row] : pressed[row] || pressed[column])
        entry.valueRef() = row == column ? 1 : 0;
    }
}

}  // namespace

Eigen::VectorXd Thigh::forces(const Eigen::VectorXd& u) const {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(points());
  subtract_forces(u, f);
  f *= -1;
  return f;
}

void Thigh::subtract_forces(const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> f) const {
  f -= a.cwiseProduct((b.cwiseProduct(u)).unaryExpr([](double x) { return std::expm1(x); }));
  for (const SkinSpring& spring : skin) {
    const double pull = spring.stiffness * (u[spring.i] - u[spring.j]);
    f[spring.i] -= pull;
    f[spring.j] += pull;
  }
}

Matrix Thigh::stiffness(const Eigen::VectorXd& u) const {
  std::vector<Eigen::Triplet<double, Eigen::Index>> entries;
  entries.reserve(static_cast<std::size_t>(points()) + 4 * skin.size());
  for (Eigen::Index i = 0; i < points(); ++i) entries.emplace_back(i, i, a[i] * b[i] * std::exp(b[i] * u[i]));
  for (const auto& [i, j, along_bone, k] : skin) {
    entries.emplace_back(i, i, k);
    entries.emplace_back(j, j, k);
    entries.emplace_back(i, j, -k);
    entries.emplace_back(j, i, -k);
  }
  Matrix K(points(), points());
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

Thigh true_thigh(Eigen::Index around, Eigen::Index along) {
  if (around < 2 || along < 2)
    throw std::invalid_argument(
        fmt::format("a thigh of {} x {} points is too small; give at least 2 x 2", around, along));
  Thigh thigh{.around = around, .along = along, .a{}, .b{}, .skin{}};
  thigh.a.resize(thigh.points());
  thigh.b.resize(thigh.points());
  for (Eigen::Index row = 0; row < around; ++row)
    for (Eigen::Index column = 0; column < along; ++column) {
      const Eigen::Index n = row * along + column;
      const double s = 2 * static_cast<double>(row) / static_cast<double>(around - 1) - 1;
      const double t = 2 * static_cast<double>(column) / static_cast<double>(along - 1) - 1;
      thigh.a[n] = young(s, t) * arc * spacing / growth;
      thigh.b[n] = growth / tissue_depth(s, t);
      // A strip under tension resists a displacement across it by tension * width / length.
      if (column + 1 < along)
        thigh.skin.push_back({.i = n, .j = n + 1, .along = true, .stiffness = tension * arc / spacing});
      if (row + 1 < around)
        thigh.skin.push_back({.i = n, .j = n + along, .along = false, .stiffness = tension * spacing / arc});
    }
  return thigh;
}

Eigen::Vector2d point_distances() { return {arc, spacing}; }

Eigen::VectorXd tissue_depths(const Thigh& thigh) { return growth * thigh.b.cwiseInverse(); }

std::vector<Eigen::Index> pressed_points(const Thigh& thigh, Eigen::Index point, Probe probe) {
  if (point < 0 || point >= thigh.points())
    throw std::invalid_argument(fmt::format("there is no point {} on a thigh of {} points; they count from 0",
                                            point, thigh.points()));
  std::vector<Eigen::Index> pressed{point};
  const Eigen::Index column = point % thigh.along;
  if (probe == Probe::surface) {
    if (column > 0) pressed.push_back(point - 1);
    if (column + 1 < thigh.along) pressed.push_back(point + 1);
  } else if (probe == Probe::across) {
    if (point >= thigh.along) pressed.push_back(point - thigh.along);
    if (point + thigh.along < thigh.points()) pressed.push_back(point + thigh.along);
  }
  return pressed;
}

std::vector<PressedThigh> press(const Thigh& thigh, std::span<const Eigen::Index> pressed,
                                std::span<const double> depths) {
  require_valid(thigh, depths);
  const Eigen::Index n = thigh.points();
  std::vector<bool> is_pressed(static_cast<std::size_t>(n));
  Eigen::VectorXd on = Eigen::VectorXd::Zero(n);  // 1 at pressed points
  for (const Eigen::Index p : pressed) {
    is_pressed.at(static_cast<std::size_t>(p)) = true;
    on[p] = 1;
  }
  Eigen::SimplicialLDLT<Matrix> solver;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(n), slope;
  // Factors K of the free points at u and finds the slope K_ff w_f = -K_fp 1.
  const auto factor = [&] {
    Matrix K = thigh.stiffness(u);
    Eigen::VectorXd load = -(K * on);
    load = (on.array() > 0).select(on, load);
    hold(K, is_pressed);
    if (solver.rows() != n) solver.analyzePattern(K);
    solver.factorize(K);
    slope = solver.solve(load);
  };
  factor();
  std::vector<PressedThigh> found;
  double depth = 0;
  for (const double next : depths) {
    u += (next - depth) * slope;
    depth = next;
    constexpr int most_iterations = 200;
    bool converged = false;
    for (int k = 0; k < most_iterations && !converged; ++k) {
      const Eigen::VectorXd r = (1 - on.array()) * thigh.forces(u).array();
      factor();
      const Eigen::VectorXd step = solver.solve(r);
      if (!step.allFinite()) break;
      u -= step;
      converged = step.lpNorm<Eigen::Infinity>() <= 1e-11 * depth;  // the next error is its square
    }
    const double force = converged ? on.dot(thigh.forces(u)) : std::numeric_limits<double>::quiet_NaN();
    found.push_back({.depth = depth, .force = force, .u = u, .slope = slope});
    if (std::isfinite(force)) continue;
    u.setZero();
    factor();
    depth = 0;
  }
  return found;
}

Eigen::VectorXd force_gradient(const Thigh& thigh, const PressedThigh& at) {
  const Eigen::Index n = thigh.points();
  Eigen::VectorXd gradient(2 * n + static_cast<Eigen::Index>(thigh.skin.size()));
  for (Eigen::Index i = 0; i < n; ++i) {
    gradient[i] = at.slope[i] * std::expm1(thigh.b[i] * at.u[i]);
    gradient[n + i] = at.slope[i] * thigh.a[i] * at.u[i] * std::exp(thigh.b[i] * at.u[i]);
  }
  Eigen::Index k = 2 * n;
  for (const SkinSpring& spring : thigh.skin)
    gradient[k++] = (at.slope[spring.i] - at.slope[spring.j]) * (at.u[spring.i] - at.u[spring.j]);
  return gradient;
}

}  // namespace hmax
