#include "bench/timing/sweeper.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/timing/timing.hpp"
#include "core/errors.hpp"

namespace hmax {

std::vector<std::size_t> Sweeper::missing(const SweepBlock& block) const {
  std::vector<std::size_t> methods;
  std::ranges::copy_if(block.methods, std::back_inserter(methods), [&](std::size_t m) {
    const RowKey key = row_key(plan_, block, m);
    return !(explores_ ? store_.contains(key) : store_.contains_measured(key));
  });
  return methods;
}

void Sweeper::keep(std::span<const Row> rows) {
  store_.insert(rows);
  summary_.measured += static_cast<std::int64_t>(rows.size());
}

void Sweeper::tell(double fraction, const std::string& what) const {
  if (progress_)
    progress_({.rows_done = summary_.skipped + summary_.measured,
               .rows = plan_.rows(),
               .fraction = fraction,
               .what = what});
}

void Sweeper::begin_session() {
  const Fingerprint here = fingerprint();
  if (here.debug_build && store_.notes().contains("published"))
    throw InputError(
        fmt::format("the store '{}' is published and takes no rows of a debug build; build with `cmake "
                    "--preset release`, or give another --out",
                    store_.file().string()));
  if (here.debug_build)
    warn("this is a debug build; its times are marked and say nothing about a release build");
  if (const std::vector<Session> sessions = store_.sessions(); !sessions.empty())
    if (const auto changes = differences(sessions.back().fingerprint, here); !changes.empty())
      warn(fmt::format("the rows stored before were measured otherwise ({})", fmt::join(changes, "; ")));
  if (plan_.spec.explore)
    warn(
        "explored on all cores: the CPU times are approximate, and no figure or comparison takes them; a sweep without "
        "--explore measures them");
  session_ = store_.begin_session(here);
}

SweepSummary Sweeper::run(const std::function<void(const std::vector<SweepTask>& tasks)>& measure) {
  const double started = elapsed_seconds();
  std::vector<SweepTask> tasks;
  for (const SweepBlock& block : plan_.blocks) {
    std::vector<std::size_t> methods = missing(block);
    summary_.skipped += static_cast<std::int64_t>(block.methods.size() - methods.size());
    if (!methods.empty()) tasks.push_back({&block, std::move(methods)});
  }
  if (!tasks.empty()) begin_session();
  try {
    measure(tasks);
  } catch (const SweepEnded&) {
    summary_.interrupted = true;
  }
  summary_.rows = store_.size();
  summary_.seconds = elapsed_seconds() - started;
  return summary_;
}

}  // namespace hmax
