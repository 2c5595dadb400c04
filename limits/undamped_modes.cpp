#include "limits/undamped_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "limits/linearised_problem.hpp"
#include "limits/modes/mode_curve.hpp"
#include "limits/modes/mode_start.hpp"

namespace hmax {

UndampedModes undamped_modes(OperatingPoint point, std::size_t most) {
  Linearised near{.point = std::move(point)};
  MechanicalPart& part = *near.point.model.mechanical;
  const AnyMatrix C = part.C;
  std::visit([](auto& held) { held.setZero(); }, part.C);
  part.damping = Damping::none;
  near.modes = mode_set(near.point.model, near.point.is_body);
  std::vector<MechanicalMode> slow = near.modes.spectrum.mechanical;
  std::ranges::sort(slow, {}, &MechanicalMode::kappa);
  // What moves as a rigid body has a stiffness of rounding.
  const double rounding = slow.empty()
                              ? 0
                              : 4 * std::numeric_limits<double>::epsilon() *
                                    static_cast<double>(part.mass.size()) * std::max(0.0, slow.back().kappa);
  std::erase_if(slow, [&](const MechanicalMode& each) { return !(each.kappa > rounding); });
  const auto& curve = near.modes.curve;
  UndampedModes found{.stiff = !slow.empty() || curve};
  const auto damped = [&](const MechanicalMode& mode, const Eigen::VectorXd& x) {
    const Eigen::VectorXd Cx = std::visit([&](const auto& held) -> Eigen::VectorXd { return held * x; }, C);
    return MechanicalMode{mode.kappa, x.dot(Cx)};
  };
  if (!slow.empty()) found.fastest = damped(slow.back(), shape_of_mode(near, slow.back()));
  if (curve) {  // of large structures the ends are known alone
    const double least = near.modes.slow_end ? near.modes.slow_end->of(part, *curve) : curve->kappa_min;
    slow.clear();
    if (least > rounding) slow.push_back(curve->at(least));
  }
  slow.resize(std::min(slow.size(), most));
  found.shapes.resize(part.mass.size(), static_cast<Eigen::Index>(slow.size()));
  for (std::size_t k = 0; k < slow.size(); ++k) {
    const Eigen::VectorXd x = shape_of_mode(near, slow[k]);
    found.slowest.push_back(damped(slow[k], x));
    found.shapes.col(static_cast<Eigen::Index>(k)) = x;
  }
  return found;
}

}  // namespace hmax
