#include "analysis/foreign_steps/step_growth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/spectrum/lanczos.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::VectorXd;

/// Growth of less is no growth, however exact the products are.
constexpr double least_tolerance = 1e-9;

struct Stage {
  int power;  ///< J^power is the operator
  Index basis, kept, products;
};
/// Isolated multipliers at the edge of the spectrum converge in the first; what grows among many of modulus 1
/// in the second.
constexpr std::array stages{Stage{1, 60, 20, 180}, Stage{8, 80, 24, 136}};

/// The largest multipliers that have to be known before the others are taken for smaller.
constexpr std::size_t leading = 8;

class GrowthSearch {
 public:
  GrowthSearch(const LinearOperator& J, Index n, const GrowthSettings& settings)
      : J_(J), n_(n), settings_(settings) {}

  ProductGrowth run() {
    for (const Stage& stage : stages) {
      power_ = stage.power;
      const RitzSearch end =
          visit_ritz_spectra([&](const VectorXd& v) { return powered(v); }, start_vector(n_),
                             {.basis = stage.basis, .kept = stage.kept, .most_products = stage.products}, 20,
                             [&](const RitzSpectrum& ritz) { return is_decided(ritz); });
      if (end == RitzSearch::decided) return found_;
      if (end == RitzSearch::not_finite)
        return {.grows = true, .multiplier = infinity, .motion = VectorXd::Zero(n_)};
    }
    found_.resolved = false;
    // A motion that was amplified by e^10 more than the others had been seen.
    found_.tolerance = std::max(found_.tolerance,
                                10.0 / (stages.back().power * static_cast<double>(stages.back().products)));
    return found_;
  }

 private:
  VectorXd powered(VectorXd v) const {
    for (int i = 0; i < power_ && v.allFinite(); ++i) v = J_(v);
    return v;
  }

  /// ln of the factor of a step.
  [[nodiscard]] double rate(const RitzValue& ritz) const { return std::log(std::abs(ritz.value)) / power_; }
  /// A space that has one vector of a pair that meets takes its values for well-conditioned ones. Pairs meet
  /// at 1, as those of rigid motions, and at -1: there the condition is that of two values as far apart as
  /// the value is from there.
  [[nodiscard]] double condition(const RitzValue& ritz, double share) const {
    const double away = std::min(std::abs(ritz.value - 1.0), std::abs(ritz.value + 1.0));
    return std::max(ritz.condition, share * power_ / away);
  }
  /// Of a rate, by what the iteration has left.
  [[nodiscard]] double left(const RitzValue& ritz) const {
    return 2 * condition(ritz, 10) * ritz.residual / (power_ * std::abs(ritz.value));
  }
  [[nodiscard]] double tolerance(const RitzValue& ritz, double error) const {
    return multiplier_tolerance(error, condition(ritz, 5));
  }

  bool is_decided(const RitzSpectrum& ritz) {
    if (finds_growth(ritz)) return true;
    // What is largest is known and does not grow, or lies within the unit circle by more than its residual.
    double bar = least_tolerance;
    std::size_t known = 0;
    const std::size_t count = std::min(leading, ritz.values.size());
    for (; known < count; ++known) {
      const RitzValue& value = ritz.values[known];
      const bool converged =
          ritz.invariant || value.residual <= std::max(1e-7, 10 * settings_.error) || left(value) <= 1e-6;
      if (converged)
        bar = std::max(bar, tolerance(value, settings_.error));
      else if (!(std::abs(value.value) + value.residual <= 1))
        break;
    }
    if (known > 0) keep(ritz, 0, bar);
    return known == count;
  }

  bool finds_growth(const RitzSpectrum& ritz) {
    int asked = 0;
    for (std::size_t i = 0; i < ritz.values.size() && asked < 3; ++i) {
      const RitzValue& value = ritz.values[i];
      if (!(std::abs(value.value) > 1)) break;
      // Conjugates have one modulus.
      if (value.value.imag() < 0) continue;
      const double excess = rate(value) - left(value);
      if (!(excess > tolerance(value, settings_.error))) continue;
      ++asked;
      const Eigen::VectorXcd x = ritz.vector(i);
      const double bar = tolerance(value, error_along(x));
      if (!(excess > bar)) continue;
      keep(ritz, i, bar);
      found_.grows = true;
      return true;
    }
    return false;
  }

  [[nodiscard]] double error_along(const Eigen::VectorXcd& x) const {
    if (!settings_.error_along) return settings_.error;
    const VectorXd re = x.real(), im = x.imag();
    return std::max(settings_.error_along(re), im.norm() > 1e-6 * re.norm() ? settings_.error_along(im) : 0);
  }

  void keep(const RitzSpectrum& ritz, std::size_t i, double bar) {
    const Eigen::VectorXcd x = ritz.vector(i);
    found_.motion = x.cwiseAbs();
    found_.tolerance = bar;
    found_.multiplier = ritz.values[i].value;
    if (power_ == 1) return;
    // x^H J x, of the modulus that the power tells more exactly.
    const VectorXd re = x.real(), im = x.imag();
    const Eigen::VectorXcd image = J_(re).cast<Complex>() + Complex(0, 1) * J_(im).cast<Complex>();
    const Complex quotient = x.dot(image);
    found_.multiplier = std::polar(std::exp(rate(ritz.values[i])), std::arg(quotient));
  }

  const LinearOperator& J_;
  Index n_;
  const GrowthSettings& settings_;
  int power_ = 1;
  ProductGrowth found_{.multiplier = 1.0, .motion = VectorXd()};
};

}  // namespace

double multiplier_tolerance(double error, double condition) {
  const double defective = 10 * std::sqrt(error);
  return least_tolerance +
         (std::isfinite(condition) ? std::min(4 * error * condition, defective) : defective);
}

ProductGrowth growth_of_products(const LinearOperator& J, Index n, const GrowthSettings& settings) {
  ProductGrowth found = GrowthSearch(J, n, settings).run();
  if (found.motion.size() == 0) found.motion = VectorXd::Zero(n);
  return found;
}

}  // namespace hmax
