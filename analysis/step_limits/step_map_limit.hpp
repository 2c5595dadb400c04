/// The largest stable step of maps of one step of which only values are known.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "analysis/spectrum/arnoldi.hpp"

namespace hmax {

/// What `steps` steps make of a small motion y, shape (n); linear in y unless said otherwise. Anything not
/// finite where the motion leaves the range of numbers.
using StepMap = std::function<Eigen::VectorXd(const Eigen::VectorXd& y, int steps)>;
/// The same at a step size h [s].
using StepMapAt = std::function<StepMap(double h)>;

/// How the limit is sought. An iteration in which growth of less than about 1e-3 a step is to be told from
/// motions that neither grow nor decay takes thousands of steps.
struct StepMapSettings {
  bool linear = true;   ///< false: only homogeneous, S(c y) = c S(y), as with truncated iterations inside
  double least = 0;     ///< [s] where the search begins; up to a thousandth of it where that is not stable
  double most = 0;      ///< [s] where it ends
  double stride = 1.5;  ///< between the steps that are tried: narrower windows of instability may lie between
  double resolution = 1e-4;   ///< to which the limit is sought, relative
  double weak_growth = 1e-6;  ///< ln of the factor of a step that is no growth yet
  int power = 8;              ///< steps of one product
  int long_power = 64;        ///< of the products that follow where the first ones do not tell
  int long_products = 48;     ///< so many of them before the Arnoldi iteration with them begins
  /// Of linear maps of so many states at most the matrix is made, which is exact.
  Eigen::Index dense_to = 400;
  Eigen::Index basis = 21, most_products = 126;  ///< of the Arnoldi iteration
  int blocks = 96;                               ///< of homogeneous maps: products from each start
  LinearOperator inner = {};                     ///< as ArnoldiSettings::inner: an energy
  std::function<void()> watch = {};              ///< called before each step size; may throw
};

/// The growth of motions at one step size.
struct StepGrowth {
  double rate = 0;         ///< ln of the factor of a step; infinity beyond the range of numbers
  bool grows = false;      ///< above weak_growth, and by more than the iteration leaves open
  Eigen::VectorXd motion;  ///< that grows fastest or decays slowest, shape (n)
  bool resolved = true;    ///< false: an iteration ended undecided, and something may grow unseen
};

/// Of linear maps the spectral radius, by their matrix or by Arnoldi iteration on S^power; of homogeneous
/// ones the largest mean of ln |S y| / |y| along orbits from several starts, which is all that bounds them.
StepGrowth growth_of_steps(const StepMap& map, const Eigen::VectorXd& start, const StepMapSettings& settings);

struct StepMapLimit {
  double h_max = 0;        ///< [s]; infinity where no step up to `most` grows, 0 where every one does
  Eigen::VectorXd motion;  ///< that begins to grow, shape (n)
  bool resolved = true;    ///< of all step sizes below: as StepGrowth::resolved
};

/// The first step size at which motions grow: by strides from `least` to `most`, then by secants and halves.
/// @param n  of the states
StepMapLimit first_growing_step(const StepMapAt& map_at, Eigen::Index n, const StepMapSettings& settings);

}  // namespace hmax
