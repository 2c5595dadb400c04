/// Sweeps: problems x methods x steps (or tolerances), each counted, checked against a reference, timed and
/// stored.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/chosen_methods.hpp"
#include "problems/oscillator/liver_problems.hpp"
#include "results/store.hpp"

namespace hmax {

/// A problem of a sweep as it is asked for.
struct SweepProblem {
  std::string name = "liver_forced";  ///< catalogue id, or the path of a file of formulas
  ProblemSettings settings;
};

/// The methods of the default sweep, as names of choose_methods: every explicit one-step method, and the
/// study's other solvers.
std::vector<std::string> study_methods();

struct Tolerance {
  double rtol, atol;
};

/// What is swept; as it stands it is the study's step sweep. What "step" means is read in two ways: `fixed`
/// integrates with h, `sampled` steps adaptively and outputs at every multiple of h, as MATLAB does for
/// 0:h:T.
struct SweepSpec {
  std::vector<SweepProblem> problems{SweepProblem{}};
  std::vector<std::string> methods;  ///< as of choose_methods; empty: study_methods(), or only the tableaux
  std::vector<std::filesystem::path> tableaux;                              ///< files of users' methods
  std::vector<double> h{liver_step_sizes.begin(), liver_step_sizes.end()};  ///< steps or output intervals [s]
  bool fixed = true, sampled = true;  ///< readings of h; `sampled` needs an error estimate
  std::vector<double> unsteered_h;    ///< fixed steps [s] of the methods without an error estimate alone
  Tolerance sampled_tolerance{1e-6, 1e-6};
  std::vector<Tolerance> tolerances;  ///< adaptive runs without output, besides those over h
  Controllers control = Controllers::deadband;
  std::optional<double> t_end;  ///< [s]; absent: each problem's own
  /// Puts the methods that a device runs on it; the sweep then has these alone. Null: all run on the
  /// processor.
  /// @param left_out  becomes the others, with the reason
  std::function<void(const std::vector<Problem>& problems, std::vector<Method>& methods,
                     std::vector<LeftOut>& left_out)>
      place{};
  int repeats = 9;  ///< timed repetitions, at least 9, of an exploring sweep at least 1
  /// On all cores, many rows at once: see Row::explored. Otherwise one thread, kept on its core, measures
  /// all.
  bool explore = false;
  /// Whether runs are timed by themselves. One repetition of an exploring sweep is the counted run: its time
  /// is rough in any case.
  [[nodiscard]] bool repeats_runs() const { return !explore || repeats > 1; }
  std::int64_t max_steps = 1'000'000'000;
  /// A sample is made of as many runs as take this long [s].
  double min_sample_s = 2e-3;
  /// CPU time of one run [s] after which it is given up, as hopeless ones of low order are.
  double budget_s = std::numeric_limits<double>::infinity();
};

/// Rows that are measured together, in turn, and stored in one transaction: all methods at one h or
/// tolerance.
struct SweepBlock {
  std::size_t problem = 0;           ///< index into SweepPlan::problems
  std::string mode;                  ///< fixed, sampled, adaptive
  RunSpec run;                       ///< `every` is the h of mode sampled
  std::vector<std::size_t> methods;  ///< indices into SweepPlan::methods
};

/// A sweep that was checked from end to end before anything runs.
struct SweepPlan {
  SweepSpec spec;
  std::vector<Problem> problems{};
  std::vector<Method> methods{};
  std::vector<SweepBlock> blocks{};
  std::vector<LeftOut> left_out{};  ///< methods that no block runs
  /// All that decides the rows, as JSON with every default filled in and the text of users' files: two plans
  /// with equal texts measure the same rows.
  std::string canonical{};

  [[nodiscard]] std::int64_t rows() const;
};

/// Expected CPU time of some methods of a block [s], good enough to divide a sweep and to tell how long it
/// still takes: 15 ns for a stage or a point of output of two numbers, and at least a sample each, or some
/// milliseconds where rows are not timed by themselves.
double expected_cost(const SweepPlan& plan, const SweepBlock& block, const std::vector<std::size_t>& methods);

/// One of `count` parts of a sweep, for programs that run beside each other.
struct Shard {
  int index = 1;  ///< from 1 to count
  int count = 1;
};

/// The blocks of one shard: a stretch of the plan of about one part in `count` of the expected cost, so that
/// a shard needs the references of few problems. Every block is in one shard; where blocks are few some
/// shards are empty. `canonical` stays that of the whole sweep: stores of shards can be merged and resumed as
/// one.
/// @throws InputError  unless 1 <= index <= count
SweepPlan shard_of(SweepPlan plan, Shard shard);

/// Key of the row of one method in one block.
RowKey row_key(const SweepPlan& plan, const SweepBlock& block, std::size_t method);

/// Checks `spec` with every method on every problem.
/// @throws InputError  for unknown names, numbers out of range, methods or problems given twice, a reading
/// that
///                     no method can do, more than 2e8 numbers of output kept at a time
SweepPlan plan_sweep(const SweepSpec& spec);

/// Whether open_sweep_store() with `resume` would take up `file`: it is missing, empty, or made by this
/// sweep.
bool can_resume(const SweepPlan& plan, const std::filesystem::path& file);

/// The store of a sweep, made when it is missing. A store with rows is taken up again only with `resume` and
/// only for the sweep it was made by.
/// @throws InputError  naming what differs and the remedy; what Store throws
Store open_sweep_store(const SweepPlan& plan, const std::filesystem::path& file, bool resume);

/// @throws InputError in a debug build: its times are not published
void require_publishable_build();

/// Notes in `store` that its rows may be published.
/// @throws InputError when a debug build measured some of them
void mark_published(Store& store);

struct SweepProgress {
  std::int64_t rows_done = 0, rows = 0;  ///< of the plan; those skipped count as done
  double fraction = 0;                   ///< of the estimated CPU time of what is to be measured
  std::string what;                      ///< "liver_forced, fixed, h = 0.01"
};

/// A part of a sweep that one of many processes measured.
struct DealtTask {
  int rank = 0;
  std::string problem;  ///< its id, with the material
  std::int64_t rows = 0;
  double expected_seconds = 0;  ///< by expected_cost()
  double seconds = 0;           ///< elapsed, with the reference of the problem where the rank did not know it
};

struct SweepSummary {
  std::int64_t rows = 0;      ///< in the store
  std::int64_t measured = 0;  ///< in this call
  std::int64_t skipped = 0;   ///< were there already
  double seconds = 0;         ///< elapsed
  bool interrupted = false;
  std::vector<std::string> warnings;  ///< sentences: debug build, another machine than before, ...
  int ranks = 1;                      ///< processes that shared it, see SweepDealer
  std::int64_t hands = 0;             ///< messages with rows
  double dealing_seconds = 0;         ///< elapsed time that rank 0 took for messages and for storing rows
  std::vector<DealtTask> tasks;       ///< in the order in which they were stored; empty without SweepDealer
};

/// Measures what is missing in `store`, on a device by its own clock. Block by block: each method runs once
/// with its evaluations counted, its errors measured and subnormal numbers noticed; then all are timed in
/// turn; then the rows are committed together. An exploring sweep does the same with each row by itself,
/// those of one problem from long to short, and with one repetition takes the time of the counted run. The
/// end state of the timed runs must agree with the counted run bit for bit (std::logic_error otherwise), so
/// no time is stored without its error.
/// @param progress     called often, also inside of a block; may be empty
/// @param interrupted  asked often; true ends the sweep without the block at hand; may be empty. An exploring
/// sweep asks in all threads at once.
SweepSummary run_sweep(const SweepPlan& plan, Store& store,
                       const std::function<void(const SweepProgress&)>& progress = {},
                       const std::function<bool()>& interrupted = {});

}  // namespace hmax
