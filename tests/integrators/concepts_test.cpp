/// What counts as a system and as a stepper, and what does not. The compiler is the test.
#include <string>

#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"
#include "problems/oscillator/oscillator.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using State = Eigen::Vector2d;
using Rk4Step = Rk<tableaux::Rk4, State>;

struct WithoutState {
  static int dim() { return 2; }
  void rhs(double, const State&, State&) const {}
};
struct WithoutDim {
  using State = Eigen::Vector2d;
  void rhs(double, const State&, State&) const {}
};
struct WithoutRhs {
  using State = Eigen::Vector2d;
  static int dim() { return 2; }
};
struct RhsIsNotConst : WithoutRhs {
  void rhs(double, const State&, State&) {}
};
struct RhsChangesY : WithoutRhs {
  void rhs(double, State&, State&) const {}
};
struct DimIsText : WithoutDim {
  static std::string dim() { return "2"; }
};
struct Autonomous : WithoutRhs {
  void rhs(double, const State&, State&) const {}
};

static_assert(System<Autonomous> && System<Oscillator> && System<Pendulum<Eigen::VectorXd>>);
static_assert(!System<WithoutState> && !System<WithoutDim> && !System<WithoutRhs> && !System<int>);
static_assert(!System<RhsIsNotConst> && !System<RhsChangesY> && !System<DimIsText>);

struct JacobianOfWrongShape : Autonomous {
  void jacobian(double, const State&, Eigen::Matrix3d&) const {}
};
struct JacobianOfRightShape : Autonomous {
  void jacobian(double, const State&, Eigen::Matrix2d&) const {}
};

static_assert(DifferentiableSystem<Oscillator> && DifferentiableSystem<JacobianOfRightShape>);
static_assert(!DifferentiableSystem<Autonomous> && !DifferentiableSystem<JacobianOfWrongShape>);
static_assert(std::is_same_v<jacobian_of<Eigen::VectorXf>, Eigen::MatrixXf>);

struct SplitsWithoutRhsAt : Autonomous {
  static double at(double t) { return t; }
};
struct Splits : SplitsWithoutRhsAt {
  void rhs_at(double, const State&, State&) const {}
};

static_assert(TimeSplitSystem<Oscillator> && TimeSplitSystem<Splits> && TimeSplitSystem<Counted<Oscillator>>);
static_assert(!TimeSplitSystem<Autonomous> && !TimeSplitSystem<SplitsWithoutRhsAt>);
static_assert(System<Counted<Autonomous>> && !TimeSplitSystem<Counted<Autonomous>>);

struct AttemptSaysNothing {
  static constexpr int order = 1, error_order = 0;
  template <class Sys>
  void init(const Sys&, double, const State&) {}
  template <class Sys>
  void attempt(const Sys&, double, const State&, double, State&) {}
  void accept(const State&) {}
  template <class Sys>
  void interpolate(const Sys&, double, double, const State&, const State&, double, State&) {}
};

static_assert(Stepper<Rk4Step, Oscillator>);
static_assert(Stepper<ExplicitRk<RuntimeTableau, State>, Oscillator>);
static_assert(Stepper<Rk<tableaux::Dop853, Eigen::VectorXf>, Pendulum<Eigen::VectorXf>>);
static_assert(!Stepper<Rk4Step, WithoutRhs> && !Stepper<int, Oscillator>);
static_assert(!Stepper<AttemptSaysNothing, Oscillator>);

// Error control cannot even be asked of a method without an error estimate.
template <class StepperT>
concept EstimatesError = requires(StepperT stepper, const State& y) {
  stepper.error_squared(1.0, y, y, RmsNorm<double>{});
};
static_assert(EstimatesError<Rk<tableaux::DormandPrince54, State>>);
static_assert(EstimatesError<ExplicitRk<RuntimeTableau, State>>);
static_assert(!EstimatesError<Rk4Step>);

TEST(Concepts, AreCheckedByTheCompiler) { EXPECT_EQ(to_string(Outcome::reached_end), "reached_end"); }

}  // namespace
}  // namespace hmax
