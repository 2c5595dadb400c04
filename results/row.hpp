/// One measured run: what was asked, what happened, what it cost, how wrong it was.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "results/fields.hpp"

namespace hmax {

/// What identifies a measurement; two rows with equal keys measure the same thing.
struct RowKey {
  std::string problem;     ///< catalogue id, or the name a user's file gives itself
  std::string material{};  ///< material id, empty when the problem has none
  std::string parameters;  ///< all parameters, "m=1.45 c=2 ...", shortest digits that read back equal
  std::string y0;          ///< initial state, "0.5,1"
  std::string method;      ///< method id
  std::string mode;      ///< fixed: steps of h; sampled: adaptive inside, output every h; adaptive: rtol only
  std::string control;   ///< none | i | pi | deadband | matlab | own
  std::string device{};  ///< name of the device that runs it, such as a GPU; empty: the processor
  std::string precision{};  ///< of the numbers of a device, double; empty: the processor
  double h = 0;             ///< step or output interval [s]; 0 in mode adaptive
  double rtol = 0;          ///< relative tolerance; 0 in mode fixed
  double atol = 0;          ///< absolute tolerance; 0 in mode fixed
  double t_end = 0;         ///< end time asked for [s]

  auto operator<=>(const RowKey&) const = default;
};

inline constexpr Field<RowKey> row_key_fields[] = {HMAX_FIELDS(RowKey, problem, material, parameters, y0,
                                                               method, mode, control, device, precision, h,
                                                               rtol, atol, t_end)};

/// A measurement. Numbers that could not be obtained are NaN; `status` then says why.
struct Row {
  RowKey key;
  std::string outcome;        ///< reached_end, diverged, step_too_small, too_many_steps, ...
  double t_reached = 0;       ///< time of the last accepted point, or of divergence [s]
  std::int64_t steps = 0;     ///< accepted steps
  std::int64_t rejected = 0;  ///< rejected attempts
  std::int64_t rhs = 0;       ///< evaluations of f
  std::vector<double> cpu_s;  ///< CPU time of one run, one entry per repetition, in the order measured [s]
  std::vector<double> device_s{};    ///< the same of a device by its own clock; a row has one of the two
  double clock_mhz = 0;              ///< the highest of the device; 0 of the processor
  std::string driver{};              ///< of the device, with its run time; empty of the processor
  std::int64_t runs_per_sample = 1;  ///< runs timed together in one repetition
  double error_end = 0;              ///< max norm of the error at t_end
  double error_global = 0;           ///< largest max-norm error over all output points
  double error_l2 = 0;               ///< root mean square over time of the max-norm error; NaN in old rows
  double reference_error = 0;        ///< bound on the error of the reference itself
  std::string reference;             ///< what the errors were measured against
  std::int64_t subnormals = 0;       ///< state components that were subnormal at some accepted step
  std::string status;                ///< empty when every number is there; otherwise one sentence
  bool explored = false;             ///< measured beside other rows on all cores, not alone on one
  std::int64_t session = 0;          ///< session that measured it; set by the store, 0 before
};

inline constexpr Field<Row> row_fields[] = {HMAX_FIELDS(
    Row, outcome, t_reached, steps, rejected, rhs, cpu_s, device_s, clock_mhz, driver, runs_per_sample,
    error_end, error_global, error_l2, reference_error, reference, subnormals, status, explored)};

/// Order statistics of the samples of one row [s].
struct TimingSummary {
  double median, q1, q3, p99;
};

/// Whether a device ran it, and not the processor.
bool is_on_device(const Row& row);

/// The samples of a row by the clock of what ran it: `device_s` where it has a device, else `cpu_s`. Those of
/// different devices, the processor among them, are never compared.
const std::vector<double>& times_of(const Row& row);
/// "device time" or "CPU time"
std::string_view name_of_time(const RowKey& key);

/// Those that figures and comparisons may use: none where the row was explored.
std::vector<double> comparable_times(const Row& row);

/// Quantiles by linear interpolation between order statistics (type 7 of [hyndman1996sample]); NaN when there
/// is no sample or one is NaN.
TimingSummary summarise(std::vector<double> samples);

}  // namespace hmax
