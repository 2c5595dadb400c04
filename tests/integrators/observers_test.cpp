/// Sampling and events read the dense output and never change the run.
#include "integrators/observers.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using Plane = Eigen::Vector2d;
using tableaux::DormandPrince54;
constexpr double pi = std::numbers::pi;

const Plane north(0, 1);

struct Sample {
  double t;
  Plane y;
};

std::vector<Sample> samples(Span<double> span, double interval, double h) {
  std::vector<Sample> found;
  Plane y(std::sin(span.t0), std::cos(span.t0));
  auto sink = [&](double t, const Plane& state) { found.push_back({t, state}); };
  integrate(Rk<DormandPrince54, Plane>{}, rotation<Plane>, span, y, FixedStep<double>(h),
            SampleEvery<Plane, decltype(sink)>(span, interval, y, sink));
  return found;
}

TEST(SampleEvery, ReportsComputedTimesFromTheFirstToTheLast) {
  for (const double interval : {0.1, 0.15, 1.0 / 3, 0.07, 2.0})
    for (const double h : {0.03, 0.1, 0.25}) {
      const auto found = samples({0.5, 10.5}, interval, h);
      const auto count = static_cast<std::size_t>(std::ceil(10 / interval - 1e-9));
      ASSERT_EQ(found.size(), count + 1) << interval << ' ' << h;
      for (std::size_t j = 0; j < count; ++j) ASSERT_EQ(found[j].t, 0.5 + static_cast<double>(j) * interval);
      EXPECT_EQ(found.back().t, 10.5);
      for (const Sample& sample : found) {
        EXPECT_NEAR(sample.y[0], std::sin(sample.t), 1e-4);
        EXPECT_NEAR(sample.y[1], std::cos(sample.t), 1e-4);
      }
    }
}

TEST(SampleEvery, LargerThanTheSpanReportsBothEnds) {
  for (const double interval : {1.5, 1e12}) {
    const auto found = samples({1, 2}, interval, 0.3);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].t, 1);
    EXPECT_EQ(found[1].t, 2);
  }
}

TEST(SampleEvery, OfAnEmptySpanReportsTheStart) { EXPECT_EQ(samples({1, 1}, 0.1, 0.1).size(), 1U); }

TEST(SampleEvery, SeesTheStatesOfStepsAsTheyAre) {
  std::vector<Plane> steps;
  Plane y = north;
  integrate(Rk<DormandPrince54, Plane>{}, rotation<Plane>, Span<double>{0, 1}, y, FixedStep<double>(0.1),
            [&](auto& view) { steps.push_back(view.y1()); });
  const auto found = samples({0, 1}, 0.1, 0.1);
  ASSERT_EQ(found.size(), steps.size() + 1);
  for (std::size_t n = 0; n < steps.size(); ++n) EXPECT_EQ(found[n + 1].y, steps[n]);
}

TEST(Observers, DoNotChangeTheRun) {
  const Adaptive<double, PiController> control({1e-7, 1e-7}, 5);
  Plane alone = north, watched = north;
  const auto one =
      integrate(Rk<DormandPrince54, Plane>{}, rotation<Plane>, Span<double>{0, 10}, alone, control);
  Plane between;
  const auto two = integrate(Rk<DormandPrince54, Plane>{}, rotation<Plane>, Span<double>{0, 10}, watched,
                             control, [&](auto& view) { view.at(view.t0() + view.h() / 3, between); });
  EXPECT_EQ(alone, watched);
  EXPECT_EQ(one.stats.steps, two.stats.steps);
}

struct Found {
  std::vector<Event<Plane>> events;
  RunEnd<double> end;
  Plane y;
};

template <class G>
Found find(G g, Crossing crossing, bool terminal, double t_end = 10, double h = 0.05) {
  Found found{{}, {}, north};
  found.end = integrate(Rk<tableaux::Dop853, Plane>{}, rotation<Plane>, Span<double>{0, t_end}, found.y,
                        FixedStep<double>(h), EventFinder<Plane, G>(g, crossing, terminal, found.events));
  return found;
}

const auto displacement = [](double, const Plane& y) { return y[0]; };
const auto velocity = [](double, const Plane& y) { return y[1]; };

TEST(EventFinder, LocatesCrossingsToRounding) {
  const Found found = find(velocity, Crossing::any, false);  // cos t = 0
  ASSERT_EQ(found.events.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(found.events[k].t, (static_cast<double>(k) + 0.5) * pi, 1e-13);
    EXPECT_NEAR(found.events[k].y[1], 0, 1e-14);
  }
  EXPECT_EQ(found.end.outcome, Outcome::reached_end);
}

TEST(EventFinder, TellsRisingFromFalling) {
  const Found rising = find(velocity, Crossing::rising, false);
  ASSERT_EQ(rising.events.size(), 1U);
  EXPECT_NEAR(rising.events[0].t, 1.5 * pi, 1e-13);
  EXPECT_EQ(find(velocity, Crossing::falling, false).events.size(), 2U);
}

TEST(EventFinder, DoesNotCountTheZeroItStartsOn) {
  const Found found = find(displacement, Crossing::any, false);  // sin t = 0 at 0, pi, 2 pi, 3 pi
  ASSERT_EQ(found.events.size(), 3U);
  EXPECT_NEAR(found.events[0].t, pi, 1e-13);
}

TEST(EventFinder, EndsTheRunAtATerminalEvent) {
  const Found found = find(displacement, Crossing::falling, true);
  EXPECT_EQ(found.end.outcome, Outcome::stopped);
  EXPECT_NEAR(found.end.t, pi, 1e-13);
  ASSERT_EQ(found.events.size(), 1U);
  EXPECT_EQ(found.y, found.events[0].y);
  EXPECT_NEAR(found.y[1], -1, 1e-13);
}

TEST(EventFinder, CountsAnEventAtTheEndOfAStepOnce) {
  // t - 2 is zero at the end of a step of 0.5, to the last bit.
  const auto two_oclock = [](double t, const Plane&) { return t - 2; };
  for (const Crossing crossing : {Crossing::any, Crossing::rising}) {
    const Found found = find(two_oclock, crossing, false, 10, 0.5);
    ASSERT_EQ(found.events.size(), 1U);
    EXPECT_EQ(found.events[0].t, 2);
  }
  EXPECT_EQ(find(two_oclock, Crossing::rising, true, 10, 0.5).end.t, 2);
  EXPECT_EQ(find(two_oclock, Crossing::any, false, 2, 0.5).events.size(), 1U) << "at the end of the run";
}

/// x = 0.5 first at pi / 6, v = 0 first at pi / 2; both in one step of a run from 0 to 10 by steps of 2.
struct Both {
  std::vector<Event<Plane>> half, turn;
  std::vector<double> times;
  int steps = 0;
  RunEnd<double> end;
  Plane y = north;
};

/// @param order  order(half, turn, sample, count) -> what observe() makes of them
template <class Order>
Both watch(const Order& order, bool half_ends, bool turn_ends) {
  Both both;
  const Span<double> span{0, 10};
  const auto from_half = [](double, const Plane& y) { return y[0] - 0.5; };
  EventFinder half(from_half, Crossing::rising, half_ends, both.half);
  EventFinder turn(velocity, Crossing::falling, turn_ends, both.turn);
  SampleEvery sample(span, 0.25, both.y, [&](double t, const Plane&) { both.times.push_back(t); });
  const auto count = [&](auto&) { ++both.steps; };
  both.end = integrate(Rk<tableaux::Dop853, Plane>{}, rotation<Plane>, span, both.y, FixedStep<double>(2),
                       order(half, turn, sample, count));
  return both;
}
const auto in_order = [](auto&... all) { return observe(all...); };
const auto turn_first = [](auto& half, auto& turn, auto&... rest) { return observe(turn, half, rest...); };

TEST(Observe, ShowsEveryStepToEach) {
  const Both both = watch(in_order, false, false);
  EXPECT_EQ(both.end.outcome, Outcome::reached_end);
  EXPECT_EQ(both.steps, 5);
  EXPECT_EQ(both.times.size(), 41U);
  EXPECT_EQ(both.half.size(), 2U);
  EXPECT_EQ(both.turn.size(), 2U);
}

TEST(Observe, EndsTheRunWhereTheFirstOfThemAsks) {
  for (const auto& both : {watch(in_order, true, true), watch(turn_first, true, true)}) {
    EXPECT_EQ(both.end.outcome, Outcome::stopped);
    EXPECT_NEAR(both.end.t, pi / 6, 1e-3);
    ASSERT_EQ(both.half.size(), 1U);
    EXPECT_EQ(both.end.t, both.half[0].t);
    EXPECT_EQ(both.y, both.half[0].y);
    EXPECT_EQ(both.times, (std::vector<double>{0, 0.25, 0.5}));
    EXPECT_EQ(both.steps, 1);
  }
}

TEST(Observe, LooksNoFurtherThanAnObserverBeforeHasEndedTheRun) {
  EXPECT_TRUE(watch(in_order, true, false).turn.empty());
  const Both both = watch(turn_first, false, true);
  EXPECT_NEAR(both.end.t, pi / 2, 1e-3);
  EXPECT_EQ(both.half.size(), 1U) << "it lies before the turn";
  EXPECT_EQ(both.times.back(), 1.5);
}

TEST(Observe, OwnsObserversWithoutAName) {
  int calls = 0;
  const auto more = [&calls] { return [&calls](auto&) { ++calls; }; };
  static_assert(sizeof(observe(more())) == sizeof(more()), "one observer costs nothing more");
  auto two = observe(more(), more());
  Plane y = north;
  integrate(Rk<DormandPrince54, Plane>{}, rotation<Plane>, Span<double>{0, 1}, y, FixedStep<double>(0.25),
            observe(two, more()));
  EXPECT_EQ(calls, 3 * 4);
}

TEST(Observe, OfOneIsThatOne) {
  std::vector<double> alone, listed;
  for (const bool wrapped : {false, true}) {
    Plane y = north;
    auto& times = wrapped ? listed : alone;
    const auto note = [&](auto& step) { times.push_back(step.t1() + step.y1()[0]); };
    const auto go = [&](auto&& observer) {
      integrate(Rk<DormandPrince54, Plane>{}, rotation<Plane>, Span<double>{0, 10}, y,
                Adaptive<double, PiController>({1e-7, 1e-7}, 5), observer);
    };
    wrapped ? go(observe(note)) : go(note);
  }
  EXPECT_EQ(alone, listed);
}

}  // namespace
}  // namespace hmax
