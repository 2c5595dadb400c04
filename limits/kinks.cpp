#include "limits/kinks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "core/errors.hpp"

namespace hmax {

namespace {

double norm_of_jacobian(const LinearModel& model) {
  return std::visit([](const auto& J) { return J.norm(); }, model.J());
}

/// The model beside a state; nothing where it has no finite Jacobian.
std::optional<LinearModel> model_beside(const OperatingPoint& point, const Eigen::VectorXd& y) {
  try {
    return point.model_at(y);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<KinkedComponent> kinks_at(const Problem& problem, double t, const Eigen::VectorXd& y, double size,
                                      KinkPlace place, std::size_t most) {
  return std::visit(
      [&]<class Sys>(const Sys& system) {
        using State = typename Sys::State;
        const State here(y);  // NOLINT(performance-unnecessary-copy-initialization): mostly of another type
        State moved = here, f = here, above = here, below = here;
        system.rhs(t, here, f);
        const double least = size > 0 ? 1e-3 * size : 1e-4,
                     noise = 1e3 * std::numeric_limits<double>::epsilon() * f.cwiseAbs().maxCoeff();
        // How far f is from a straight line over a reach, beside how far it goes.
        const auto bend = [&](Eigen::Index j, double d) {
          moved[j] = y[j] + d;
          system.rhs(t, moved, above);
          moved[j] = y[j] - d;
          system.rhs(t, moved, below);
          moved[j] = y[j];
          const double change =
              std::max((above - f).cwiseAbs().maxCoeff(), (f - below).cwiseAbs().maxCoeff());
          return std::pair{(above + below - 2 * f).cwiseAbs().maxCoeff(), change};
        };
        std::vector<KinkedComponent> kinks;
        for (Eigen::Index j = 0; j < y.size() && kinks.size() < most; ++j) {
          // Twice the reach of jacobian_by_differences().
          const double d =
              2 * std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(std::abs(y[j]), least);
          const auto [off, change] = bend(j, d);
          if (off <= 0.01 * change + noise) continue;
          // At a hundredth of the reach a jump of the slope is a hundredth, x |x|^(1/2) a thousandth, x^2
          // 1e-4.
          if (place == KinkPlace::at_state && bend(j, d / 100).first < off / 200) continue;
          kinks.push_back({j, d});
        }
        return kinks;
      },
      problem.system);
}

// One component after the other, so that sides of several kinks are those of one state.
bool take_stiffest_side(OperatingPoint& point, const Problem& problem) {
  constexpr Eigen::Index most_states = 2000;  // each takes two calls of all rates
  if (point.is_body || problem.matrices || is_affine(point.linearity) || problem.y0.size() > most_states)
    return false;
  const Eigen::VectorXd y = point.model.y;
  const double size = std::max(y.lpNorm<Eigen::Infinity>(), problem.y0.lpNorm<Eigen::Infinity>());
  std::optional<LinearModel> stiffest;
  Eigen::VectorXd side = y;
  for (const auto& [component, reach] : kinks_at(problem, point.model.t, y, size, KinkPlace::at_state)) {
    Eigen::VectorXd up = side, down = side;
    up[component] += reach;
    down[component] -= reach;
    std::optional<LinearModel> above = model_beside(point, up), below = model_beside(point, down);
    // What bends no more than that is none for runs either.
    if (!above || !below || relative_distance(*above, *below) <= 1e-3) continue;
    const bool is_above = norm_of_jacobian(*above) > norm_of_jacobian(*below);
    side = is_above ? up : down;
    stiffest = std::move(is_above ? above : below);
  }
  if (!stiffest) return false;
  point.model = *std::move(stiffest);
  point.model.y = y;
  point.at_kink = true;
  return true;
}

}  // namespace hmax
