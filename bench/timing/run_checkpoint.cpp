#include "bench/timing/run_checkpoint.hpp"

#include <algorithm>
#include <chrono>
#include <system_error>

#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "catalogue/methods/kept_sink.hpp"
#include "core/errors.hpp"
#include "core/part_file.hpp"
#include "results/table.hpp"

namespace hmax {

/// Saves one run of the file.
class RunCheckpoint::Keeper : public RunKeeper {
 public:
  Keeper(RunCheckpoint& checkpoint, Part& part, const KeptOutput& output)
      : checkpoint_(checkpoint), part_(part), output_(output) {}

  std::optional<std::string> resume() override {
    if (part_.state.empty()) return std::nullopt;
    load_output();
    return part_.state;
  }

  bool is_due(double t) override {
    t_ = t;
    const CheckpointOptions& options = checkpoint_.options_;
    stops_ = options.stop && options.stop();
    if (stops_ || options.every == 0) return true;
    return ++asked_ >= stride_ && look(t);
  }

  void save(std::string state) override {
    part_.t = t_;
    part_.state = std::move(state);
    save_output();
    count_time();
    const std::string failure = checkpoint_.write();
    if (stops_ && !failure.empty())
      throw InputError(failure + "; what was computed since the last checkpoint is lost");
    if (stops_) throw InterruptedRun{t_};
    if (!failure.empty() && !told_ && checkpoint_.options_.remark)
      checkpoint_.options_.remark(failure + "; the run goes on");
    told_ = told_ || !failure.empty();
    saved_ = Clock::now();
  }

  void load_output() const {
    StateBytes bytes(part_.output);
    StateLoader load(bytes);
    if (!output_.visit) return;
    output_.visit(load);
    if (!bytes.at_end()) throw BadState("the points are longer than they say");
  }
  void save_output() {
    StateBytes bytes;
    StateSaver saver(bytes);
    if (output_.visit) output_.visit(saver);
    part_.output = bytes.bytes();
  }

  /// Of this process and those before it.
  void count_time() {
    part_.cpu_seconds = cpu_before_ + clock_() - cpu_start_;
    part_.elapsed_seconds = elapsed_before_ + elapsed_seconds() - start_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Looks at the clock, which takes as long as some steps: so many steps apart that it is about a
  /// millisecond.
  bool look(double t) {
    const auto now = Clock::now(), before = std::exchange(looked_, now);
    asked_ = 0;
    constexpr std::int64_t most = 1 << 20;
    if (now - before < std::chrono::milliseconds(1))
      stride_ = std::min(2 * stride_, most);
    else if (now - before > std::chrono::milliseconds(4))
      stride_ = std::max<std::int64_t>(stride_ / 4, 1);
    if (checkpoint_.options_.progress) checkpoint_.options_.progress(t);
    return std::chrono::duration<double>(now - saved_).count() >= checkpoint_.options_.every;
  }

  RunCheckpoint& checkpoint_;
  Part& part_;
  const KeptOutput& output_;
  CpuClock clock_ = cpu_clock();
  double t_ = 0, cpu_start_ = clock_(), cpu_before_ = part_.cpu_seconds;
  double start_ = elapsed_seconds(), elapsed_before_ = part_.elapsed_seconds;
  bool stops_ = false, told_ = false;
  std::int64_t asked_ = 0,
               stride_ = 1;  ///< calls of is_due() since the clock was read, and between two readings
  Clock::time_point looked_ = Clock::now(), saved_ = looked_;
};

RunCheckpoint::RunCheckpoint(CheckpointOptions options) : options_(std::move(options)) {
  const std::filesystem::path& file = options_.file;
  try {
    lock_.emplace(file);
  } catch (const std::runtime_error& error) {
    throw InputError(error.what());
  }
  if (lock_->is_held()) remove_left_parts(file);
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored)) read();
  check_writable(file, checkpoint_opening);
}

void RunCheckpoint::read() try {
  const std::filesystem::path& file = options_.file;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw InputError(fmt::format("checkpoint {} is no regular file; give another name", file.string()));
  Checkpoint found = read_checkpoint(file);
  if (const auto difference = first_difference(found.facts, options_.facts))
    throw InputError(fmt::format(
        "checkpoint {} is of another run: {}; repeat the command of that run, or name another file",
        file.string(), *difference));
  StateBytes bytes(std::move(found.state));
  StateLoader load(bytes);
  load(parts_);
  if (!bytes.at_end()) throw BadState("the runs are longer than they say");
  for (Part& part : parts_) part.record.note = part.note;
} catch (const InputError&) {
  throw;
} catch (const BadState&) {
  throw InputError(damaged_checkpoint(options_.file));
} catch (const std::runtime_error& error) {
  throw InputError(error.what());
}

const RunCheckpoint::Part* RunCheckpoint::find(std::string_view name) const {
  const auto found = std::ranges::find(parts_, name, &Part::name);
  return found == parts_.end() ? nullptr : &*found;
}

RunCheckpoint::Part& RunCheckpoint::part_of(const std::string& name) {
  const auto found = std::ranges::find(parts_, name, &Part::name);
  return found == parts_.end() ? parts_.emplace_back(Part{.name = name}) : *found;
}

double RunCheckpoint::resumes_at(std::string_view name) const {
  const Part* part = find(name);
  return part ? part->t : -1;
}

bool RunCheckpoint::has_finished(std::string_view name) const {
  const Part* part = find(name);
  return part && part->finished;
}

std::string RunCheckpoint::write() {
  StateBytes bytes;
  StateSaver saver(bytes);
  saver(parts_);
  try {
    write_checkpoint(options_.file, {options_.facts, bytes.bytes()});
    return {};
  } catch (const std::system_error& error) {
    return fmt::format("the checkpoint {} cannot be written ({})", options_.file.string(),
                       error.code().message());
  }
}

CountedRun RunCheckpoint::run(const std::string& name, const Runner& runner, const RunSpec& spec,
                              const KeptOutput& output) try {
  Part& part = part_of(name);
  Keeper keeper(*this, part, output);
  if (part.finished) {
    keeper.load_output();
    return {part.record, part.cpu_seconds, part.elapsed_seconds};
  }
  part.record = runner.run(spec, KeptSink(output.sink, keeper));
  keeper.count_time();
  part.finished = true;
  part.t = part.record.t;
  part.note = part.record.note;
  part.state.clear();
  keeper.save_output();
  if (const std::string failure = write(); !failure.empty() && options_.remark) options_.remark(failure);
  return {part.record, part.cpu_seconds, part.elapsed_seconds};
} catch (const BadState&) {
  throw InputError(damaged_checkpoint(options_.file));
}

}  // namespace hmax
