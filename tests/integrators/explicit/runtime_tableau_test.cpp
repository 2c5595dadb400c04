/// A tableau read at run time steps as the same tableau known to the compiler.
#include "integrators/explicit/runtime_tableau.hpp"

#include <cmath>

#include "integrators/integrate.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using Plane = Eigen::Vector2d;
using Runtime = ExplicitRk<RuntimeTableau, Plane>;

template <class Method>
RuntimeTableau at_run_time() {
  const auto& t = Method::tableau;
  RuntimeTableau tableau{.name = std::string(Method::id),
                         .a = {},
                         .b = {t.b.begin(), t.b.end()},
                         .b_err = {t.b_err.begin(), t.b_err.end()},
                         .c = {t.c.begin(), t.c.end()},
                         .computed_order = Method::order,
                         .embedded_order = Method::embedded_order,
                         .fsal = is_fsal(t)};
  for (const auto& row : t.a) tableau.a.insert(tableau.a.end(), row.begin(), row.end());
  return tableau;
}

template <class Method>
struct AtRunTime : testing::Test {};
TYPED_TEST_SUITE(AtRunTime, EveryMethod, MethodId);

TYPED_TEST(AtRunTime, StepsAndEstimatesAsAtCompileTime) {
  const Pendulum<Plane> system;
  const RmsNorm<double> norm{0, 1};
  Rk<TypeParam, Plane> known;
  Runtime read(at_run_time<TypeParam>());
  Plane y(0.3, 0.5), y_known, y_read;
  known.init(system, 0, y);
  read.init(system, 0, y);
  // Three steps, so that the first stage kept from the step before counts.
  for (int n = 0; n < 3; ++n) {
    const double t = 0.2 * n;
    known.attempt(system, t, y, 0.2, y_known);
    read.attempt(system, t, y, 0.2, y_read);
    EXPECT_LT((y_known - y_read).norm(), 1e-14);
    if constexpr (TypeParam::error_order > 0 && !StaticCoefficients<TypeParam>::has_low_error) {
      const double error = std::sqrt(known.error_squared(0.2, y, y_known, norm));
      EXPECT_NEAR(std::sqrt(read.error_squared(0.2, y, y_read, norm)), error, 1e-15);
    }
    known.accept(y_known);
    read.accept(y_read);
    y = y_known;
  }
}

TYPED_TEST(AtRunTime, ReadsBetweenStepsByCubicHermite) {
  const Pendulum<Plane> system;
  Runtime read(at_run_time<TypeParam>());
  const Plane y(0.3, 0.5);
  Plane y_new, between, f0, f1;
  read.init(system, 0, y);
  read.attempt(system, 0, y, 0.2, y_new);
  read.interpolate(system, 0, 0.2, y, y_new, 0.5, between);
  system.rhs(0, y, f0);
  system.rhs(0.2, y_new, f1);
  // The cubic in the middle: (y + y_new) / 2 + h (f0 - f1) / 8.
  EXPECT_LT((between - ((y + y_new) / 2 + 0.2 * (f0 - f1) / 8)).norm(), 1e-15);
}

TEST(RuntimeTableau, RunsUnderErrorControlLikeTheStaticOne) {
  const Pendulum<Plane> system;
  const Adaptive<double, PiController> control({1e-8, 1e-8}, 5);
  Plane y_known(0.3, 0.5), y_read = y_known;
  const auto known =
      integrate(Rk<tableaux::DormandPrince54, Plane>{}, system, Span<double>{0, 10}, y_known, control);
  const auto read = integrate(Runtime(at_run_time<tableaux::DormandPrince54>()), system, Span<double>{0, 10},
                              y_read, control);
  EXPECT_EQ(known.stats.steps, read.stats.steps);
  EXPECT_EQ(known.stats.rejected, read.stats.rejected);
  EXPECT_LT((y_known - y_read).norm(), 1e-12);
}

}  // namespace
}  // namespace hmax
