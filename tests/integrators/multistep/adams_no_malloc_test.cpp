/// Adams methods allocate nothing after init().
#include <stdexcept>

#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(condition) \
  ((condition) ? void(0) : throw std::logic_error("Eigen's assertion failed: " #condition))

#include "integrators/control.hpp"
#include "integrators/integrate.hpp"
#include "integrators/multistep/adams.hpp"
#include "integrators/multistep/adams_pece.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using State = Eigen::VectorXd;
const Decay<State> system_of_many{State::LinSpaced(600, -2, -1)};

/// Forbids allocation from the first accepted step on, and looks between the ends of each.
struct ForbidFromTheFirstStep {
  template <class View>
  void operator()(View& view) {
    Eigen::internal::set_is_malloc_allowed(false);
    view.at(view.t0() + 0.3 * view.h(), between);
  }
  State between;
};

template <class Stepper, class Control>
RunEnd<double> run(Stepper stepper, Control control) {
  State y = State::Ones(600);
  ForbidFromTheFirstStep observer{y};
  RunEnd<double> end{};
  EXPECT_NO_THROW(end = integrate(stepper, system_of_many, {0, 3.02}, y, control, observer));
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_LT((y - (3.02 * system_of_many.lambda).array().exp().matrix()).cwiseAbs().maxCoeff(), 1e-3);
  return end;
}

TEST(AdamsAllocatesNothing, FromItsStartToItsShorterLastStep) {
  for (const AdamsMode mode : {AdamsMode::bashforth, AdamsMode::pece, AdamsMode::pec})
    for (const int k : {2, 4})
      EXPECT_EQ(run(Adams<State>(mode, k), FixedStep<double>(0.02)).stats.steps, 151);
}

TEST(AdamsAllocatesNothing, WhileItChoosesOrderAndStep) {
  using Method = AdamsPece<State>;
  const auto end = run(Method(), Method::Control({1e-6, 1e-6}));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  EXPECT_GT(end.stats.steps, 20);
}

}  // namespace
}  // namespace hmax
