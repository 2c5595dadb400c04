/// The motion by which steps are judged: pressed, held and released, or the problem's own.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/method.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

/// A problem whose own motion is what is judged.
struct ProbingMotion {
  Problem problem;
  double t_end = 0;     ///< [s]
  std::string words{};  ///< what acts, and how it comes and goes
  double load_share = 1,
         gravity_share = 1;  ///< of what the problem has; less where that has no equilibrium, or is not tried
};

/// Of a body whose loads do not change with time: they come within 0.1 s, stay for 0.2 s and go within 0.1 s,
/// and the body moves freely for 0.2 s. Gravity, or the most of it that has an equilibrium, acts all the
/// time, from there on. A body without any other load is pressed at its far end until it gives way by 2 % of
/// its size; one that nothing holds is pulled at both ends until it is deformed as much. A load without an
/// equilibrium is halved, up to six times, until it has one, and then taken as large as moves the body by 2 %
/// of its size. Of bodies whose loads change with time, and of what is no body: the problem's own motion, up
/// to its end.
/// @param frame  [s]: where it is longer than 0.05 s, the load stays for four of it, and is gone for four
ProbingMotion probing_motion(const Problem& problem, const Watcher& watcher = {}, double frame = 0);

/// A body as it rests under gravity, which is scaled by the largest share 1, 1/2, ..., 1/64 with an
/// equilibrium; without gravity where there is none, or none acts.
struct RestingBody {
  Problem problem;      ///< y0 is the equilibrium without other loads
  std::string words{};  ///< " beside gravity"; empty where none acts
  double share = 1;     ///< of gravity
};
RestingBody resting_under_gravity(const Problem& problem, const Watcher& watcher = {});

/// A force of 1 N on the far end of a body, towards what holds it: on the surface points near the one
/// furthest from its supports, or from its middle.
PressingForce far_press(const TissueBody& body);

/// A motion that no step was chosen for. A body: beside gravity and loads of its own that change with time,
/// slow oscillations across the direction of its press, as large as moves it by 1 % of its size, or along a
/// body that nothing holds, which a force across would carry away. What is no body: its own motion from half
/// of its initial state.
/// @param t_end    [s]
/// @param slowest  the slowest frequency of the body, which the load stays well below [rad/s]; 0: not known
ProbingMotion other_motion(const ProbingMotion& motion, double t_end, double slowest);

/// The motion as it truly is, at instants that are multiples of a frame.
struct ReferenceMotion {
  std::vector<double> t;           ///< [s], the first is 0
  std::vector<Eigen::VectorXd> y;  ///< shape (dim) each
  /// The largest displacement of a body [m], every 20 ms at least, or the largest range of a state.
  double scale = 0;
  Eigen::VectorXd ranges{};  ///< of what is no body: max |y_i - y_i(0)|, shape (dim); else empty
  double error_bound = 0;    ///< of the instants, relative as relative_error()
};

/// The largest stable steps at the start of a motion [s]; 0: not known.
struct ExplicitLimits {
  double central = 0;  ///< of central differences
  double rk4 = 0;
};

/// The method of an id, as the runs of a reference make it: find_method(), or on a device.
using FindMethod = std::function<Method(std::string_view id)>;

/// At most 50 instants. A body: a part of a frame of at most 10 ms, a half, a quarter, ... of it, until the
/// last halving changes nothing by more than `tolerance` / 10; the change bounds the error. By central
/// differences from 0.8 of their limit where three halvings suffice, or by rk4 from half of its limit, both
/// only from steps of 50 us or more; else by newmark. Others: the reference of the catalogue.
/// @param frame      [s]
/// @param tolerance  relative to the scale
/// @param find       how its runs find a method
/// @throws InputError  where no step is solved, or 12 halvings do not suffice, or nothing moves but by
/// rounding
ReferenceMotion reference_motion(const ProbingMotion& motion, double frame, double tolerance,
                                 const Watcher& watcher = {}, const ExplicitLimits& limits = {},
                                 const FindMethod& find = find_method);

/// What a number of the state is measured by: of a body the scale; of others the range of that number, or the
/// scale where it stays where it is but for rounding.
double scale_of_state(const ReferenceMotion& reference, Eigen::Index i);

/// The distance of a state from the reference: of a body the largest distance of a point, relative to the
/// scale; of others the largest of the states, each relative to its own range.
double relative_error(const ProbingMotion& motion, const ReferenceMotion& reference, std::size_t instant,
                      const Eigen::Ref<const Eigen::VectorXd>& y);

}  // namespace hmax
