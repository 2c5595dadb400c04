#include "bench/micro/engine.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"
#include "integrators/stats.hpp"

namespace hmax::micro {
namespace {

template <class Method>
FixedStep<double> fixed(double h) {
  return FixedStep<double>(h);
}

template <class Method>
Adaptive<double, DeadbandController> adaptive(double tolerance) {
  return {{.rtol = tolerance, .atol = tolerance}, Method::error_order};
}

template <class Method, auto Control>
Engine engine(Task task) {
  using Stepper = Rk<Method, Eigen::Vector2d>;
  return {task, "hmax", std::string(Method::id),
          [](const Oscillator& model, double t_end, double setting, Point& y) {
            Eigen::Vector2d state(y[0], y[1]);
            integrate(Stepper(), model, {0, t_end}, state, Control(setting));
            y = {state[0], state[1]};
          },
          [](const Oscillator& model, double t_end, double setting, Point y, const Watcher& watcher) {
            Eigen::Vector2d state(y[0], y[1]);
            Stats stats;
            integrate(Stepper(), Counted<Oscillator>(model, stats), {0, t_end}, state, Control(setting),
                      [&](const auto& step) {
                        watcher(step.t1(), {step.y1()[0], step.y1()[1]});
                      });
            return static_cast<long>(stats.rhs);
          }};
}

}  // namespace

std::vector<Engine> hmax_engines() {
  using namespace tableaux;
  return {engine<Rk4, fixed<Rk4>>(Task::rk4_fixed),
          engine<DormandPrince54, fixed<DormandPrince54>>(Task::dormand_prince_fixed),
          engine<Fehlberg78, fixed<Fehlberg78>>(Task::order_8_fixed),
          engine<Dop853, fixed<Dop853>>(Task::order_8_fixed),
          engine<DormandPrince54, adaptive<DormandPrince54>>(Task::dormand_prince_adaptive),
          engine<Fehlberg78, adaptive<Fehlberg78>>(Task::order_8_adaptive),
          engine<Dop853, adaptive<Dop853>>(Task::order_8_adaptive)};
}

}  // namespace hmax::micro
