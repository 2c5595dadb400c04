/// The stroboscopic view of a driven system: its state once in each period of the force, as it showed the
/// chaos of Duffing's equation [ueda1979randomly].
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/differences.hpp"
#include "integrators/control.hpp"
#include "integrators/controller.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"
#include "integrators/tolerances.hpp"

namespace hmax {

/// y -> P(y), the state one period after y; f(t + period, .) = f(t, .), so that every look is the same map
/// and no phase is lost in a long run. NaN where the motion diverges. The order 8 of dop_853, each period
/// ending exactly at its end; the system is copied.
/// P of Poincare: periodic motions of period p T are orbits of p points of P, and the eigenvalues of D P
/// at a fixed point are the Floquet multipliers.
/// @param period      [s], positive
/// @param tolerances  of each step; the absolute one small against the motion
/// @param most_steps  after which a period that has not ended is taken for one that diverges
template <System S>
VectorFunction period_map(S system, double period, const Tolerances<double>& tolerances = {1e-11, 1e-11},
                          std::int64_t most_steps = 1'000'000) {
  return [system = std::move(system), period, tolerances,
          most_steps](const Eigen::VectorXd& from) -> Eigen::VectorXd {
    using State = typename S::State;
    State y = from;
    const auto end =
        integrate(Rk<tableaux::Dop853, State>{}, system, Span<double>{0, period}, y,
                  Adaptive<double, DeadbandController>(tolerances, tableaux::Dop853::error_order),
                  ObserveNothing{}, most_steps);
    if (end.outcome != Outcome::reached_end) y.setConstant(std::numeric_limits<double>::quiet_NaN());
    return y;
  };
}

/// P^skip(y), P^(skip + 1)(y), ...: `count` looks after `skip` that are not kept; fewer when one is not
/// finite.
/// @param map  shape (n) to (n), such as period_map()
/// @param y    the start, shape (n)
/// @throws std::invalid_argument when skip or count is negative
std::vector<Eigen::VectorXd> looks(const VectorFunction& map, Eigen::VectorXd y, int skip, int count);

/// What is seen of motions, in units of the state; the default is for states of about 1.
struct Resolution {
  double rest = 1e-12;   ///< a motion of this size is at rest
  double error = 1e-11;  ///< of the map
};

/// The smallest p such that every look equals the one p looks later, to `tolerance` of the largest |y_i| and
/// `rest`; nothing when there is none up to a quarter of the looks, or where for a divisor of p the looks are
/// hardly further apart: they then still alternate around an orbit of that period, or have just left it.
/// The verdict needs 4 p looks at least: a period of 64 shows in 256.
std::optional<int> period_of(const std::vector<Eigen::VectorXd>& looks, double tolerance = 1e-6,
                             double rest = Resolution().rest);

/// When an exponent is known well enough; all of them per application of the map.
struct ExponentLimits {
  double relative = 0.02;  ///< ends at this share of |exponent| as error
  double absolute = 3e-3;  ///< or at this error
  int least = 400;         ///< but not before so many applications,
  int most = 40'000;       ///< and after these in any case
};

/// A Lyapunov exponent and what is known of it.
/// Divided by the period of the force [s] it is the exponent in time [1/s].
struct Exponent {
  double value;          ///< per application of the map
  double error;          ///< of the value, 95 %
  int count;             ///< applications that were averaged
  Eigen::VectorXd end;   ///< shape (n), where the orbit has ended
  bool at_most = false;  ///< the value is a bound: neighbours have met but for rounding

  /// Neighbours part, beyond the error.
  [[nodiscard]] bool positive() const { return !at_most && value > error; }
};

/// The largest Lyapunov exponent of the orbit through y, per application of the map: the mean logarithm by
/// which a small separation grows, brought back to its size after each. Positive in chaos. NaN when the orbit
/// diverges. [benettin1976kolmogorov]
///
/// The error is Student's of the means of 16 consecutive batches, which knows that neighbouring periods are
/// not independent, and no less than the difference of the two halves or 2 ln(N) / N after N applications,
/// the mean that neighbours show which part as N^2: where nothing is damped they part by powers, without
/// chaos.
/// An exponent below 50 times the absolute error may be that of a motion that still settles, evenly slow in
/// both halves: it is looked at again after twice as many applications, and the error is no less than what it
/// has changed. Nor is it less than 0.003: the rounding of a map that is integrated, seen at a separation of
/// a millionth, turns neighbours aside and lets those that part by powers part by some 0.001 per application.
/// Of neighbours nearer than some hundred ulps of y, where rounding hides how near, that stands for their
/// distance: the value is a bound.
///
/// With e_0 of size 1e-6 in units of `scale`:
///   lambda = (1 / N) sum_i ln(|d_i| / |e_i|),   d_i = P(y_i + e_i) - P(y_i),   e_i+1 = d_i |e_0| / |d_i|.
/// The first 20 applications only turn e into the direction that grows fastest and are not counted.
/// @param scale  shape (n), positive: the size of the motion
Exponent largest_lyapunov(const VectorFunction& map, const Eigen::VectorXd& y, const Eigen::VectorXd& scale,
                          const ExponentLimits& limits = {});

/// What a motion comes to.
enum class Settling {
  periodic,   ///< it repeats
  chaotic,    ///< it does not, and its exponent is positive beyond its error
  unsettled,  ///< neither was seen: it is on its way, takes very many periods, or fills a curve
  diverges
};
/// "periodic", "chaotic", "not_settled", "diverges"
std::string_view name_of(Settling settling);

/// The verdict on a motion, the same in sections and diagrams.
struct Settled {
  Settling settling;
  std::optional<int> period = {};           ///< in looks, of a periodic one
  std::optional<Exponent> exponent = {};    ///< of one that does not repeat
  int followed = 0;                         ///< applications of the map after the looks that came first
  std::vector<Eigen::VectorXd> looks = {};  ///< where it has settled; those that came first if they repeat
};

/// Judges the motion that `looks` shows. Where they do not repeat it is followed for some 3000 applications
/// of the map, in which chaos that does not last dies out, and then for as many as its exponent takes;
/// periods of up to 64 are known.
/// Order: looks that repeat are periodic; else the map is applied in blocks of 256 up to some 3000 times,
/// each block tested for a period; then the exponent decides.
/// @param count  how many looks belong to the motion; with fewer it has diverged
/// @param seen   no separation of less than ten errors of the map is looked at
Settled settle(const VectorFunction& map, std::vector<Eigen::VectorXd> looks, int count,
               const ExponentLimits& limits, const Resolution& seen = {});

/// A state that waits for its image.
struct MapCall {
  std::size_t map;         ///< its number
  Eigen::VectorXd* state;  ///< which the image replaces; not finite where there is none
  void* motion;            ///< whose state it is
};

/// States that wait, those of several motions at a time.
struct MapCalls {
  std::function<std::optional<MapCall>()>
      next;                                  ///< nothing while all wait for images under way, or have ended
  std::function<void(const MapCall&)> done;  ///< the state has been replaced
};

/// Replaces states until next() has none and all are done; called by several threads at once.
using MapEnsemble = std::function<void(const MapCalls& calls)>;

/// One image after the other.
/// @param map_at  makes a map of its number; called by several threads at once
MapEnsemble one_by_one(std::function<VectorFunction(std::size_t map)> map_at);

/// What is seen at one value of a parameter.
struct BifurcationColumn {
  double value;
  Settled motion;  ///< its looks are fewer than asked for when it diverges
};

/// Looks for each value of a parameter, on all cores. Each motion is judged by `settle`, the exponent only as
/// well as its sign takes.
/// A bifurcation diagram plots the looks over the parameter: period doubling shows as branches that split.
/// Each motion is what it is alone.
/// @param skip, count  looks that are not kept, and kept, at each value
/// @param follow  each value starts where the one before has ended, instead of at y0: the branch is followed,
///                by one thread
/// @param going   called by one thread with the share that is done; when it returns false the diagram ends
///                with the values that are done up to the first that is not
/// @param seen    as of settle()
std::vector<BifurcationColumn> bifurcation(const MapEnsemble& ensemble, const std::vector<double>& values,
                                           const Eigen::VectorXd& y0, int skip, int count, bool follow,
                                           const std::function<bool(double)>& going = {},
                                           const Resolution& seen = {});

}  // namespace hmax
