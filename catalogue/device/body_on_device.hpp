/// Bodies and their states in the memory of a device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "catalogue/device/device.hpp"
#include "catalogue/device/device_method.hpp"
#include "catalogue/device/newton_on_device.hpp"
#include "catalogue/device/patches/body_patches.hpp"
#include "catalogue/device/positional_on_device.hpp"
#include "catalogue/device/radius_on_device.hpp"

namespace hmax {

/// Steps a body by one method, or many bodies that differ in their states alone.
/// @tparam Real  of all its numbers, double or float; those of the body are rounded once
template <class Real>
class BodyOnDevice {
 public:
  /// At most so many steps at a time.
  static constexpr std::int64_t most_steps = 4096;

  /// @param device, body  outlive this
  /// @param bodies  at a time
  /// @throws InputError  for a method that has no such numbers, or not of many bodies
  BodyOnDevice(Device& device, const TissueBody& body, DeviceMethod method, std::int32_t bodies = 1);
  BodyOnDevice(const BodyOnDevice&) = delete;
  BodyOnDevice& operator=(const BodyOnDevice&) = delete;

  [[nodiscard]] Device& device() const { return device_; }
  [[nodiscard]] const DeviceMethod& method() const { return method_; }
  /// The next step, from the state that get() has.
  [[nodiscard]] const BodyStep<Real>& step() const { return step_; }
  /// Of each free point of the body: its number there.
  [[nodiscard]] const std::vector<std::int32_t>& order() const { return patches_.order; }
  /// Whether loads change with time or supports move, so that steps need set_times().
  [[nodiscard]] bool is_driven() const { return step_.next_loads != 0; }

  /// @param y  of each body, or the one state of all; shape (dim)
  void set(std::span<const Eigen::VectorXd> y);
  /// That of body `number`.
  [[nodiscard]] Eigen::VectorXd get(std::int32_t number = 0) const { return get(step_.q, step_.v, number); }
  /// Of displacements and velocities as those of BodyStep.
  [[nodiscard]] Eigen::VectorXd get(const Real* q, const Real* v, std::int32_t number = 0) const;
  /// Where the evaluations that follow stand [s]: 0 of a start, or those of all steps of advance().
  void set_times(std::span<const double> times);
  /// What a step needs besides (q, v): the acceleration, of methods that kick.
  void start();
  void advance(double h, std::int64_t count);
  /// How many steps advance() may take at a time.
  [[nodiscard]] std::int64_t steps_at_once() const;
  /// Of methods whose stages follow the spectral radius: finds that at displacements q, as of BodyStep, and
  /// time t [s], before the times of the step are told. Nothing of others.
  void find_radius(Real* q, double t);
  /// What steps of h have in common: stages by the last radius that was found, a frozen matrix.
  void prepare(double h);
  /// The longest step that is stable with the most stages [s]; infinite of other methods.
  [[nodiscard]] double longest_step() const;
  /// Appends the stages of a Runge-Kutta or stabilised method, as many evaluations as instants().
  /// @param known  the stage of an earlier step whose slope is that of the first one, which then is not
  ///               evaluated
  void append_stages(BodyStep<Real> step, std::vector<DeviceProgram>& programs,
                     std::optional<std::int32_t> known = {}) const;
  /// h w_0 k_0 + h w_1 k_1 ..., of the slopes of step.sum.
  [[nodiscard]] static StageSum<Real> sum_of(const BodyStep<Real>& step,
                                             std::span<const long double> weights);
  /// Programs of evaluations that stand at `times` [s], once.
  void run(std::span<const DeviceProgram> programs, std::span<const double> times);
  /// Whether a point was beyond what is watched since the last call.
  [[nodiscard]] bool left();
  void keep();
  void go_back();
  /// Counts steps that were taken or tried, as advance() does.
  void count_steps(std::int64_t steps);
  /// Evaluations of forces in them since set().
  [[nodiscard]] std::int64_t evaluations() const { return counted_.evaluations; }
  /// Conjugate gradients since set().
  [[nodiscard]] std::int64_t linear_iterations() { return newton_ ? newton_->iterations() : 0; }

  /// Operations of the elements of all bodies, and bytes of elements, rims, states and point data, in a step;
  /// of many bodies those of elements and points count once. Of the steps since set(), on average.
  [[nodiscard]] double flops() const;
  [[nodiscard]] double bytes() const;

 private:
  [[nodiscard]] std::size_t displacements() const {
    return sizeof(Real) * 3 * static_cast<std::size_t>(patches_.points) * bodies();
  }
  [[nodiscard]] std::size_t velocities() const { return sizeof(Real) * 3 * patches_.mass.size() * bodies(); }
  [[nodiscard]] std::size_t bodies() const { return static_cast<std::size_t>(step_.bodies); }
  [[nodiscard]] bool is_of_ten_nodes() const { return step_.body.elements == PatchElements::of_ten_nodes; }
  Real* numbers(std::size_t bytes) { return memory_.template room<Real>(bytes / sizeof(Real)); }
  template <class T>
  const T* there(const std::vector<T>& values) {
    return memory_.copy(values);
  }
  const Real* there(const std::vector<double>& values);
  [[nodiscard]] BodyArrays<Real> arrays(const BodyPatches& p);
  [[nodiscard]] std::vector<SetLaw<Real>> laws();
  [[nodiscard]] BodyTools<Real> tools();
  [[nodiscard]] SharedPressures<Real> pressures();
  /// Of an evaluation: volumes of tetrahedra and what patches read of them.
  [[nodiscard]] double bytes_of_pressures() const;
  void place_loads();
  [[nodiscard]] double evaluations_of_a_step() const;
  /// Numbers of a load in the table: where programs push by themselves, its factor alone.
  [[nodiscard]] std::size_t numbers_of_a_load() const { return method_.is_positional() ? 1 : 3; }
  /// Where numbers of an evaluation begin, those of one kind after the other: loads, motions of supports,
  /// poses of tools, rates.
  [[nodiscard]] std::int32_t first_motion() const {
    return static_cast<std::int32_t>(numbers_of_a_load() * loads_.size());
  }
  [[nodiscard]] std::int32_t first_tool() const {
    return first_motion() + 6 * static_cast<std::int32_t>(patches_.motions.size());
  }
  [[nodiscard]] std::int32_t first_rate() const {
    return first_tool() + 6 * static_cast<std::int32_t>(body_.settings().tools.size());
  }
  [[nodiscard]] std::size_t numbers_of_an_evaluation() const {
    return static_cast<std::size_t>(first_rate()) + patches_.rates.size();
  }
  void append_evaluation(double t, std::vector<Real>& table) const;
  /// diag(C) / m [1/s] at t = 0, of each body, shape (bodies, 3, free).
  [[nodiscard]] std::vector<Real> lumped_damping(std::span<const Eigen::VectorXd> y) const;

  /// Calls use(i, q, v) for each degree of freedom of body `number` with its place in the arrays of the
  /// device.
  template <class Use>
  void visit(std::size_t number, std::vector<Real>& q, std::vector<Real>& v, const Use& use) const;

  /// The next `count` steps, each of the programs that append(step, programs) makes of its BodyStep.
  template <class Append>
  void run(std::int64_t count, const Append& append);
  /// The programs one after the other, over and over again.
  /// @param instants  of all of them
  void run(std::span<const DeviceProgram> programs, std::int64_t times, std::int32_t instants);
  void append_recurrence(BodyStep<double> step, std::vector<DeviceProgram>& programs,
                         std::optional<std::int32_t> known) const;
  /// Steps of substeps, each of the programs that `iterations` appends.
  template <class Iterations>
  void advance_by(const Iterations& iterations, double h, std::int64_t count);

  Device& device_;
  const TissueBody& body_;
  DeviceMemory memory_;
  DeviceMethod method_;
  BodyPatches patches_;
  std::vector<PressingForce> loads_;
  Real* load_table_ = nullptr;
  std::int64_t* evaluated_ = nullptr;
  BodyStep<Real>* programs_ = nullptr;  ///< of BodySteps; null where a body is no single block
  BodyStep<Real> step_{};
  Real* lumped_ = nullptr;              ///< that of BodyStep
  Real *stage_q_[2]{}, *stage_v_[2]{};  ///< arguments of stages; displacements at the ends of substeps
  struct {
    Real *q, *v, *a;
  } kept_{};
  struct {
    std::int64_t steps, evaluations;
  } counted_{}, kept_counts_{};
  std::optional<RadiusOnDevice> radius_;
  double found_radius_ = 0;  ///< [1/s]
  std::optional<NewtonOnDevice> newton_;
  std::optional<ConstraintsOnDevice> constraints_;
  std::optional<PointsOnDevice> points_;
};

}  // namespace hmax
