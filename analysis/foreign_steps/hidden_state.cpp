#include "analysis/foreign_steps/hidden_state.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/spectrum/lanczos.hpp"
#include "core/numbers.hpp"

namespace hmax {

using Eigen::VectorXd;

std::vector<std::string> HiddenState::remarks(double noise, bool has_save) const {
  std::vector<std::string> found;
  const auto larger = [&](double value) { return !(value <= noise); };
  if (larger(restored))
    found.push_back("restore() does not bring the saved state back: it differs by " +
                    rounded_text(restored, 2) + " of its scale");
  if (larger(repeated)) {
    found.push_back("steps are not reproducible: from one saved state they differ by " +
                    rounded_text(repeated, 2) + " of the scale of the state" +
                    (has_save ? "; save() and restore() miss something, or threads work in another order"
                              : "; the stepper needs save() and restore()"));
    return found;
  }
  if (larger(set_again))
    found.push_back("set_state() changes more than the state: steps after it differ by " +
                    rounded_text(set_again, 2) + " of the scale");
  if (larger(history))
    found.push_back(
        "a step depends on hidden state, such as the start of an iteration: " + rounded_text(history, 2) +
        " of a change of the steps before it is still there; h_max keeps the hidden state as it is, observed "
        "lets it follow");
  return found;
}

HiddenState examine_hidden_state(ForeignStepper& engine, const StateCoordinates& coordinates,
                                 const VectorXd& scale, int slot, const VectorXd& y, double h) {
  const auto distance = [&](const VectorXd& a, const VectorXd& b) {
    return coordinates.of(a, b).cwiseQuotient(scale).cwiseAbs().maxCoeff();
  };
  const auto stepped = [&](std::int64_t count) {
    return engine.step(h, count) ? engine.state() : VectorXd(VectorXd::Constant(y.size(), std::nan("")));
  };
  HiddenState found;
  engine.restore(slot);
  found.restored = distance(y, engine.state());
  const VectorXd once = stepped(3);
  engine.restore(slot);
  found.repeated = distance(once, stepped(3));
  found.set_again = distance(once, engine.after(slot, y, h, 3));

  constexpr double detour = 1e-3;
  const VectorXd next = engine.after(slot, y, h, 1);
  const VectorXd numbers = start_vector(scale.size());
  const VectorXd away =
      coordinates.at(y, detour * numbers.cwiseProduct(scale) / numbers.cwiseAbs().maxCoeff());
  const VectorXd detoured = engine.after(slot, away, h, 5);
  // What is at rest shows no noise of its motion.
  found.repeated = std::max(found.repeated, distance(detoured, engine.after(slot, away, h, 5)));
  if (detoured.allFinite()) {
    engine.set_state(y);
    found.history = distance(next, stepped(1)) / detour;
  }
  // Where steps leave the range of numbers this tells nothing; the rows do.
  for (double* each : {&found.repeated, &found.set_again, &found.history})
    if (!std::isfinite(*each)) *each = 0;
  return found;
}

}  // namespace hmax
