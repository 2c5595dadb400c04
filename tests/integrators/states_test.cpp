/// Every kind of state: real and complex numbers of any precision, fixed and dynamic size.
#include <cmath>
#include <limits>

#include "integrators/integrate.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using tableaux::DormandPrince54;
using tableaux::Rk4;

template <class State>
Eigen::Index size_of() {
  return is_small_state<State> || State::RowsAtCompileTime > 0 ? State::RowsAtCompileTime : 7;
}

/// Decay rates between -1 and -1/2, turned by i where the state is complex.
template <class State>
State rates() {
  using Scalar = typename State::Scalar;
  const Eigen::Index n = size_of<State>();
  State lambda(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    lambda[i] =
        Scalar(-1) / Scalar(static_cast<real_of<State>>(1 + static_cast<double>(i) / static_cast<double>(n)));
    if constexpr (Eigen::NumTraits<Scalar>::IsComplex) lambda[i] *= Scalar(0, 1);
  }
  return lambda;
}

template <class StateT>
struct EveryState : testing::Test {};
// Small and large, fixed and dynamic, of every scalar; doubles of fixed size are those of all other tests.
using States = testing::Types<Eigen::Matrix<float, 2, 1>, Eigen::Matrix<double, 12, 1>, Eigen::VectorXf,
                              Eigen::Matrix<long double, 3, 1>, Eigen::VectorXcd>;
TYPED_TEST_SUITE(EveryState, States);

TYPED_TEST(EveryState, IsIntegratedInFixedStepsAndReadBetweenThem) {
  using Real = real_of<TypeParam>;
  const Decay<TypeParam> system{rates<TypeParam>()};
  TypeParam y = TypeParam::Ones(size_of<TypeParam>()), middle = y;
  const auto end = integrate(Rk<Rk4, TypeParam>{}, system, Span<Real>{0, 1}, y, FixedStep<Real>(Real(0.01L)),
                             [&](auto& view) {
                               if (view.t0() < Real(0.505) && view.t1() > Real(0.505))
                                 view.at(Real(0.505), middle);
                             });
  EXPECT_EQ(end.stats.steps, 100);
  const Real tolerance = std::max(Real(1e-9), 20 * std::numeric_limits<Real>::epsilon());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    EXPECT_LT(std::abs(y[i] - std::exp(system.lambda[i])), tolerance);
    EXPECT_LT(std::abs(middle[i] - std::exp(system.lambda[i] * Real(0.505))), tolerance);
  }
}

TYPED_TEST(EveryState, IsIntegratedToATolerance) {
  using Real = real_of<TypeParam>;
  const Decay<TypeParam> system{rates<TypeParam>()};
  const Real tolerance = std::max(Real(1e-9), 20 * std::numeric_limits<Real>::epsilon());
  TypeParam y = TypeParam::Ones(size_of<TypeParam>());
  const auto end =
      integrate(Rk<DormandPrince54, TypeParam>{}, system, Span<Real>{0, 2}, y,
                Adaptive<Real, PiController>({tolerance, tolerance}, DormandPrince54::error_order));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  for (Eigen::Index i = 0; i < y.size(); ++i)
    EXPECT_LT(std::abs(y[i] - std::exp(system.lambda[i] * Real(2))), 10 * tolerance);
}

// Both layouts evaluate one expression per component in the same order and nothing is contracted, so even
// the last bits agree.
TEST(DynamicState, GivesTheBitsOfAFixedOne) {
  const auto run = [](auto y, auto stepper) {
    using State = decltype(y);
    integrate(stepper, Pendulum<State>{}, Span<double>{0, 20}, y,
              Adaptive<double, DeadbandController>({1e-8, 1e-8}, DormandPrince54::error_order));
    return Eigen::Vector2d(y);
  };
  const Eigen::Vector2d start(0.3, 0.5);
  EXPECT_EQ(run(start, Rk<DormandPrince54, Eigen::Vector2d>{}),
            run(Eigen::VectorXd(start), Rk<DormandPrince54, Eigen::VectorXd>{}));
}

TEST(LongDouble, IsMoreThanDouble) {
  using One = Eigen::Matrix<long double, 1, 1>;
  One y(1.0L);
  integrate(Rk<tableaux::Dop853, One>{}, Decay<One>{One(-1.0L)}, Span<long double>{0, 1}, y,
            FixedStep<long double>(1 / 64.0L));
  EXPECT_LT(std::abs(y[0] - std::exp(-1.0L)), 1e-18L);
}

}  // namespace
}  // namespace hmax
