#include "studies/thigh/thigh_identification.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <unsupported/Eigen/NonLinearOptimization>

#include <Eigen/QR>
#include <fmt/format.h>

namespace hmax {

namespace {

/// From 0 to 1 without its ends: 53 bits of the generator, the same everywhere.
double uniform(std::mt19937_64& random) { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; }

/// Normally distributed numbers [box1958note].
double normal(std::mt19937_64& random) {
  const double r = std::sqrt(-2 * std::log(uniform(random)));
  return r * std::cos(2 * std::numbers::pi * uniform(random));
}

/// Student's t that 2.5 % exceed, from that of the normal distribution [abramowitz1964handbook, 26.7.5].
double student(double freedom) {
  constexpr double z = 1.959963984540054;
  constexpr double z3 = z * z * z, z5 = z3 * z * z;
  return z + (z3 + z) / (4 * freedom) + (5 * z5 + 16 * z3 + 3 * z) / (96 * freedom * freedom);
}

Eigen::Index skin_unknowns(const Thigh& thigh, UnknownSkin skin) {
  if (skin == UnknownSkin::none) return 0;
  return skin == UnknownSkin::by_direction ? 2 : static_cast<Eigen::Index>(thigh.skin.size());
}

/// Which unknown of the skin a spring has.
Eigen::Index unknown_of(const Thigh& thigh, std::size_t spring, UnknownSkin skin) {
  if (skin == UnknownSkin::every_spring) return static_cast<Eigen::Index>(spring);
  return thigh.skin[spring].along ? 0 : 1;
}

/// As Eigen's method asks for the residuals at x, the logarithms of the unknowns.
struct ThighResiduals {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const Thigh& start;
  std::span<const ForceSeries> data;
  FitOptions options;

  [[nodiscard]] Thigh at(const Eigen::VectorXd& x) const {
    return with_unknowns(start, x.array().exp().matrix(), options.skin);
  }
  [[nodiscard]] Eigen::Index values() const { return value_count(data); }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& r) const {
    // A step so long that a parameter leaves the range of numbers is rejected as one that has no force.
    const bool representable = x.allFinite() && x.lpNorm<Eigen::Infinity>() < 300;
    r = representable ? residuals(at(x), data, options)
                      : Eigen::VectorXd::Constant(values(), std::numeric_limits<double>::quiet_NaN());
    return 0;
  }
  int df(const Eigen::VectorXd& x, Eigen::MatrixXd& J) const {
    residuals(at(x), data, options, &J);
    return 0;
  }
};

/// Standard deviations of least squares with unit variance, the roots of the diagonal of (J^T J)^-1.
Eigen::VectorXd deviations(const Eigen::MatrixXd& J) {
  const Eigen::Index n = J.cols();
  const Eigen::VectorXd scale = J.colwise().norm();
  if ((scale.array() == 0).any())
    return Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  const Eigen::MatrixXd scaled = J * scale.cwiseInverse().asDiagonal();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(scaled);
  const Eigen::MatrixXd inverse =
      qr.matrixQR().topRows(n).triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
  return inverse.rowwise().norm().cwiseQuotient(scale);
}

void require_identifiable(const Thigh& start, std::span<const ForceSeries> data, UnknownSkin skin) {
  const Eigen::Index values = value_count(data), wanted = unknowns(start, skin).size();
  if (values <= wanted)
    throw std::invalid_argument(
        fmt::format("{} forces cannot tell {} parameters; measure more points or depths", values, wanted));
  for (const ForceSeries& series : data) {
    if (series.force.size() != series.depth.size())
      throw std::invalid_argument(
          fmt::format("a series of point {} has {} depths and {} forces; give one for each", series.point,
                      series.depth.size(), series.force.size()));
    for (const double force : series.force)
      if (!(force > 0))
        throw std::invalid_argument(fmt::format(
            "a force of {} N was measured at point {}; forces of a probe that presses are positive", force,
            series.point));
  }
}

}  // namespace

std::vector<ForceSeries> measured(const Thigh& thigh, const MeasurementPlan& plan) {
  constexpr double step = 0.002, most_force = 15;  // [m], [N]
  constexpr std::size_t least_values = 10, most_values = 12;
  std::vector<double> depths;
  for (std::size_t k = 1; k <= most_values; ++k) depths.push_back(step * static_cast<double>(k));
  std::mt19937_64 random(plan.seed);
  std::vector<ForceSeries> data;
  for (const Probe probe : {Probe::indentor, Probe::surface})
    for (Eigen::Index point = 0; point < thigh.points(); ++point) {
      ForceSeries series{.point = point, .probe = probe, .depth{}, .force{}};
      for (const PressedThigh& at : press(thigh, pressed_points(thigh, point, probe), depths)) {
        if (series.force.size() >= least_values && series.force.back() > most_force) break;
        series.depth.push_back(at.depth);
        series.force.push_back(at.force * (1 + plan.noise * normal(random)));
      }
      data.push_back(std::move(series));
    }
  return data;
}

Eigen::Index value_count(std::span<const ForceSeries> data) {
  std::size_t count = 0;
  for (const ForceSeries& series : data) count += series.force.size();
  return static_cast<Eigen::Index>(count);
}

Eigen::VectorXd forces_of(std::span<const ForceSeries> data) {
  Eigen::VectorXd forces(value_count(data));
  Eigen::Index k = 0;
  for (const ForceSeries& series : data)
    for (const double force : series.force) forces[k++] = force;
  return forces;
}

Eigen::VectorXd forces_of(const Thigh& thigh, std::span<const ForceSeries> data) {
  Eigen::VectorXd forces(value_count(data));
  Eigen::Index k = 0;
  for (const ForceSeries& series : data)
    for (const PressedThigh& at :
         press(thigh, pressed_points(thigh, series.point, series.probe), series.depth))
      forces[k++] = at.force;
  return forces;
}

double overall_error(const Eigen::VectorXd& forces, const Eigen::VectorXd& measured_forces) {
  return (forces - measured_forces).norm() / measured_forces.norm();
}

Eigen::VectorXd unknowns(const Thigh& thigh, UnknownSkin skin) {
  const Eigen::Index n = thigh.points(), count = skin_unknowns(thigh, skin);
  Eigen::VectorXd values(2 * n + count);
  values << thigh.a, thigh.b, Eigen::VectorXd::Zero(count);
  if (count > 0)
    for (std::size_t s = 0; s < thigh.skin.size(); ++s)
      values[2 * n + unknown_of(thigh, s, skin)] = thigh.skin[s].stiffness;
  return values;
}

Thigh with_unknowns(Thigh thigh, const Eigen::VectorXd& values, UnknownSkin skin) {
  const Eigen::Index n = thigh.points(), count = skin_unknowns(thigh, skin);
  if (values.size() != 2 * n + count)
    throw std::invalid_argument(
        fmt::format("a thigh has {} unknowns but {} values are given", 2 * n + count, values.size()));
  thigh.a = values.head(n);
  thigh.b = values.segment(n, n);
  if (count > 0)
    for (std::size_t s = 0; s < thigh.skin.size(); ++s)
      thigh.skin[s].stiffness = values[2 * n + unknown_of(thigh, s, skin)];
  return thigh;
}

Eigen::VectorXd residuals(const Thigh& thigh, std::span<const ForceSeries> data, const FitOptions& options,
                          Eigen::MatrixXd* jacobian) {
  const Eigen::Index n = thigh.points();
  const UnknownSkin skin = options.skin;
  const Eigen::VectorXd values = unknowns(thigh, skin);
  Eigen::VectorXd r(value_count(data));
  if (jacobian) jacobian->setZero(r.size(), values.size());
  Eigen::Index k = 0;
  for (const ForceSeries& series : data) {
    const auto found = press(thigh, pressed_points(thigh, series.point, series.probe), series.depth);
    for (std::size_t m = 0; m < found.size(); ++m, ++k) {
      const double ratio = found[m].force / series.force[m];
      r[k] = options.misfit == Misfit::logarithmic ? std::log(ratio) : ratio - 1;
      if (!jacobian) continue;
      const Eigen::VectorXd gradient = force_gradient(thigh, found[m]);
      Eigen::VectorXd row = Eigen::VectorXd::Zero(values.size());
      row.head(2 * n) = gradient.head(2 * n);
      if (skin != UnknownSkin::none)
        for (std::size_t s = 0; s < thigh.skin.size(); ++s)
          row[2 * n + unknown_of(thigh, s, skin)] += gradient[2 * n + static_cast<Eigen::Index>(s)];
      jacobian->row(k) = row.cwiseProduct(values) /
                         (options.misfit == Misfit::logarithmic ? found[m].force : series.force[m]);
    }
  }
  return r;
}

ThighFit identify(const Thigh& start, std::span<const ForceSeries> data, const FitOptions& options) {
  require_identifiable(start, data, options.skin);
  ThighResiduals functor{start, data, options};
  Eigen::LevenbergMarquardt<ThighResiduals> search(functor);
  search.parameters.factor = 1;  // the first step changes no logarithm by more than its size
  search.parameters.maxfev = 100;
  search.parameters.ftol = search.parameters.xtol = 1e-10;
  Eigen::VectorXd x = unknowns(start, options.skin).array().log();
  const auto status = search.minimize(x);
  using namespace Eigen::LevenbergMarquardtSpace;
  ThighFit fit{.thigh = functor.at(x),
               .values = x.array().exp(),
               .low{},
               .high{},
               .evaluations = static_cast<int>(search.nfev),
               .converged = status != ImproperInputParameters && status != TooManyFunctionEvaluation &&
                            status != UserAsked};
  Eigen::MatrixXd J;
  const Eigen::VectorXd r = residuals(fit.thigh, data, options, &J);
  fit.residual = std::sqrt(r.squaredNorm() / static_cast<double>(r.size()));
  const auto freedom = static_cast<double>(r.size() - x.size());
  const Eigen::VectorXd half = student(freedom) * std::sqrt(r.squaredNorm() / freedom) * deviations(J);
  fit.low = (x - half).array().exp();
  fit.high = (x + half).array().exp();
  return fit;
}

Thigh uniform_guess(Thigh thigh, double skin_factor) {
  thigh.a.setConstant(0.3);
  thigh.b.setConstant(60);
  for (SkinSpring& spring : thigh.skin) spring.stiffness *= skin_factor;
  return thigh;
}

Thigh scattered(Thigh thigh, double of_a, double of_b, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (double& a : thigh.a) a *= std::pow(of_a, 2 * uniform(random) - 1);
  for (double& b : thigh.b) b *= std::pow(of_b, 2 * uniform(random) - 1);
  return thigh;
}

Recovery compare(const ThighFit& fit, const Thigh& truth, UnknownSkin skin) {
  constexpr double tolerance = 0.05;
  const Eigen::ArrayXd right = unknowns(truth, skin).array();
  Recovery found{.error = fit.values.array() / right - 1};
  const auto count = static_cast<double>(right.size());
  found.within = static_cast<double>((found.error.array().abs() <= tolerance).count()) / count;
  found.covered =
      static_cast<double>((fit.low.array() <= right && right <= fit.high.array()).count()) / count;
  found.largest_error = found.error.lpNorm<Eigen::Infinity>();
  return found;
}

}  // namespace hmax
