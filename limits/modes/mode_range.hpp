/// Limits on structures whose damping couples the modes and that are too large for all of them.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "analysis/spectrum/damped_eigenvalues.hpp"
#include "analysis/step_limits/damping_range.hpp"
#include "core/size_limits.hpp"
#include "limits/point/operating_point.hpp"
#include "limits/point/prediction.hpp"

namespace hmax {

/// What is known of the modes of such a structure beside the largest eigenvalues, which the spectrum lists.
struct ModeRange {
  double rest = 0;                ///< no eigenvalue that is not listed is larger in modulus [1/s]
  std::optional<double> growing;  ///< the eigenvalue of a body that buckles [1/s]
  bool open = false;              ///< nothing but `rest` is known of the eigenvalues that are not listed
  std::unique_ptr<RangeTangents>
      tangents;  ///< to the range of all modes; null where that is open or one grows
  /// Of matrices that are elsewhere: finds what limits ask of them, and no less than the largest eigenvalues
  /// of c and k. Null where they are here.
  FindLargestOfSum find = {};
  double most_c = 0, most_k = 0;
  DampedEigenvalues largest;  ///< that the spectrum lists; none where `open`
  std::vector<std::function<DampedEigenvalues()>>
      searches;  ///< each finds more eigenvalues than the last one

  /// What search 0, 1 ... finds, once a limit asks for it, after those before: the same whoever asks first.
  /// Null beyond the last one.
  const DampedEigenvalues* more(std::size_t search);
  /// u of an eigenvalue that was found, shape (dofs); nothing for others.
  std::optional<Eigen::VectorXcd> shape_of(std::complex<double> lambda);
  /// rho with gamma >= rho kappa of all modes, found once a limit asks for it, or 0.
  double least_damping(const MechanicalPart& part);
  /// The first exit of steps that couple the modes, as far as it is proved.
  [[nodiscard]] std::optional<CoupledLimit> first_exit(const Amplification& single,
                                                       const MechanicalPart& part) const;

 private:
  std::mutex more_mutex_;
  std::deque<DampedEigenvalues> more_;
  std::once_flag damping_once_;
  double least_damping_ = 0;
};

/// Puts the largest eigenvalue of a structure with symmetric matrices and general damping into `modes`, and
/// what finds the range of all modes. False, and nothing done, for all other models.
/// @param is_body  as of set_curve()
bool set_range(const LinearModel& model, ModeSet& modes, Eigen::Index small = most_dense_coupled,
               bool is_body = true);

/// Puts the largest eigenvalues of any other model of more than most_dense_rows states into `modes`: one of
/// first order, or with matrices that are not symmetric. False, and nothing done, for smaller models, dense
/// ones, and in a build without Krylov methods.
/// @throws InputError  where the iteration does not converge
bool set_largest(const LinearModel& model, ModeSet& modes);

/// The limit of a method on such a structure.
struct LimitInRange {
  double h_max = 0;                 ///< no mode is unstable at smaller steps [s]
  Mode mode{};                      ///< that sets it, or that bounds it
  std::vector<ModeMargin> modes{};  ///< the largest eigenvalues
  std::optional<double>
      unstable_from{};  ///< where no mode is known to be unstable just beyond h_max: from here [s]
};

/// The least first exit of the largest eigenvalues, where the range says that no other mode leaves before;
/// else what the range says. The range is cut where its worst mode is, and more eigenvalues are found where
/// the worst mode is among them, until it allows the limit or no cut helps.
/// @param radius  that the method is told [1/s]
LimitInRange limit_in_range(const Amplification& amplification, const MechanicalPart& part,
                            const ModeSet& modes, double radius);

}  // namespace hmax
