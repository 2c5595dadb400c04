#include "bench/timing/dealt_sweep.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/timing/dealing.hpp"
#include "bench/timing/row_meter.hpp"
#include "bench/timing/sweep_messages.hpp"
#include "bench/timing/sweeper.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"
#include "core/ranks/thread_ranks.hpp"
#include "core/text/digest.hpp"
#include "results/fingerprint.hpp"

namespace hmax {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A digest of what a plan measures, in its order.
std::string digest_of(const SweepPlan& plan) {
  Digest digest;
  digest.add(plan.canonical);
  for (const SweepBlock& block : plan.blocks) digest.add(in_words(plan, block) + "\n");
  return digest.text();
}

/// The side of a rank that measures.
class Helper {
 public:
  Helper(Ranks& ranks, const std::function<bool()>& interrupted) : ranks_(ranks), interrupted_(interrupted) {}

  /// Until the end: measures what is dealt, or tells rank 0 why not.
  void help(const std::function<SweepPlan()>& make_plan) {
    try {
      SweepPlan plan = make_plan();
      // A thread that shares its node is not kept on one core, and its rows are explored.
      plan.spec.explore = are_times_rough(plan, ranks_);
      measure(plan);
    } catch (const SweepEnded&) {
      if (!ended_) send(RankInterrupted{});
    } catch (const InputError& error) {
      send(RankFailed{error.what(), true});
    } catch (const std::exception& error) {
      send(RankFailed{error.what(), false});
    }
    while (!ended_) next(false);
    send(RankEnded{});
  }

 private:
  void send(const SweepMessage& message) { ranks_.send(0, to_bytes(message)); }

  void measure(const SweepPlan& plan) {
    std::optional<OneThread> alone;
    if (plan.spec.explore) alone.emplace();
    send(RankReady{digest_of(plan), fingerprint()});
    const std::function<bool()> asked_to_end = [&] { return is_over(); };
    RowMeter meter(plan, nullptr, asked_to_end);
    for (Hand hand = next(true); !ended_; hand = next(true)) {
      RankRows rows;
      for (const Hand::Task& task : hand.tasks) {
        const auto started = Clock::now();
        for (Row& row : meter.measured({&plan.blocks.at(task.block), task.methods}))
          rows.rows.push_back(std::move(row));
        rows.seconds.push_back(seconds_since(started));
      }
      send(rows);
    }
  }

  /// Waits for a hand. @throws SweepEnded  when this rank is interrupted, where it `minds`
  Hand next(bool minds) {
    for (Pause pause;; pause.sleep()) {
      if (const auto message = ranks_.receive()) return taken(*message);
      if (minds && interrupted_ && interrupted_()) throw SweepEnded{};
    }
  }

  Hand taken(const Message& message) {
    Hand hand = std::get<Hand>(sweep_message(message.bytes));
    if (hand.tasks.empty()) ended_ = true;
    return hand;
  }

  /// Asked often while a hand is measured, when the end is all that can come.
  bool is_over() {
    if (interrupted_ && interrupted_()) return true;
    const auto now = Clock::now();
    if (ended_ || now < next_look_) return ended_;
    next_look_ = now + std::chrono::milliseconds(10);
    if (const auto message = ranks_.receive()) taken(*message);
    return ended_;
  }

  Ranks& ranks_;
  const std::function<bool()>& interrupted_;
  bool ended_ = false;
  Clock::time_point next_look_{};
};

/// A thread of rank 0 that measures, as one more rank.
class OwnHelper {
 public:
  OwnHelper(const SweepPlan& plan, int most_on_a_node)
      : mail_(2, most_on_a_node), thread_([this, &plan] {
          const std::function<bool()> never;
          Helper(mail_[1], never).help([&plan] { return plan; });
        }) {}
  ~OwnHelper() { mail_[0].send(1, to_bytes(Hand{})); }
  OwnHelper(const OwnHelper&) = delete;
  OwnHelper& operator=(const OwnHelper&) = delete;

  Ranks& mail() { return mail_[0]; }

 private:
  ThreadRanks mail_;
  std::jthread thread_;
};

/// The side of rank 0 that deals. Workers count from 0: the own thread, which may be missing, then the other
/// ranks.
class Dealing {
 public:
  Dealing(Ranks& ranks, Sweeper& sweeper, const std::vector<SweepTask>& tasks)
      : ranks_(ranks),
        sweeper_(sweeper),
        plan_(sweeper.plan()),
        measures_(are_times_rough(plan_, ranks) || ranks.size() == 1),
        deck_(plan_, plan_.spec.explore ? single_rows(plan_, tasks) : tasks,
              static_cast<std::size_t>(ranks.size() - (measures_ ? 0 : 1))),
        workers_(static_cast<std::size_t>(ranks.size())),
        cost_(deck_.cost()) {
    for (const SweepTask& task : tasks) rows_ += task.methods.size();
    sweeper_.summary().ranks = ranks.size();
  }

  /// Until all rows are kept and every rank has said that it measures the same sweep, however late it comes.
  void run() {
    std::optional<OwnHelper> own;
    if (measures_ && rows_ > 0) own.emplace(plan_, ranks_.most_on_a_node());
    for (Pause pause; rows_ > 0 || is_awaited();) {
      if (take(own ? &own->mail() : nullptr))
        pause.reset();
      else
        pause.sleep();
      if (sweeper_.interrupted() && sweeper_.interrupted()()) throw SweepEnded{};
    }
  }

 private:
  struct Worker {
    std::optional<std::int64_t> session;  ///< of its machine
    std::vector<SweepTask> hand;
  };

  /// Whether another rank has not begun yet.
  [[nodiscard]] bool is_awaited() const {
    return std::any_of(workers_.begin() + 1, workers_.end(),
                       [](const Worker& worker) { return !worker.session; });
  }

  /// @returns whether there was a message
  bool take(Ranks* own) {
    if (own)
      if (const auto message = own->receive()) {
        handle(0, *message, *own, 1);
        return true;
      }
    const auto message = ranks_.receive();
    if (message) handle(static_cast<std::size_t>(message->from), *message, ranks_, message->from);
    return message.has_value();
  }

  void handle(std::size_t worker, const Message& bytes, Ranks& mail, int to) {
    const auto started = Clock::now();
    const SweepMessage message = sweep_message(bytes.bytes);
    if (std::holds_alternative<RankInterrupted>(message)) throw SweepEnded{};
    if (const auto* failed = std::get_if<RankFailed>(&message)) throw_failure(worker, *failed);
    if (const auto* ready = std::get_if<RankReady>(&message)) welcome(worker, *ready);
    if (const auto* rows = std::get_if<RankRows>(&message)) keep(worker, *rows);
    deal(worker, mail, to);
    sweeper_.summary().dealing_seconds += seconds_since(started);
  }

  [[noreturn]] static void throw_failure(std::size_t worker, const RankFailed& failed) {
    const std::string what = worker == 0 ? failed.what : fmt::format("rank {}: {}", worker, failed.what);
    if (failed.is_input) throw InputError(what);
    throw std::logic_error(what);
  }

  /// @throws InputError  where a rank would measure something else
  void welcome(std::size_t worker, const RankReady& ready) {
    if (ready.machine.program != here_.program)
      throw InputError(
          fmt::format("rank {} runs another build of hmax; start the same program on all nodes", worker));
    if (ready.sweep != digest_)
      throw InputError(
          fmt::format("rank {} has another sweep; give all ranks the same options and files", worker));
    workers_[worker].session = session_of(ready.machine, worker);
  }

  std::int64_t session_of(const Fingerprint& machine, std::size_t worker) {
    const std::vector<std::string> changes = differences(here_, machine);
    if (changes.empty()) return sweeper_.session();
    const auto [known, is_new] = sessions_.try_emplace(fmt::format("{}", fmt::join(changes, "; ")), 0);
    if (is_new) {
      known->second = sweeper_.store().begin_session(machine);
      sweeper_.warn(
          fmt::format("rank {} measured on another machine than rank 0 ({})", worker, known->first));
    }
    return known->second;
  }

  void keep(std::size_t rank, const RankRows& rows) {
    Worker& worker = workers_[rank];
    std::vector<Row> done = rows.rows;
    std::size_t i = 0;
    for (const SweepTask& task : worker.hand)
      for (const std::size_t method : task.methods) done.at(i++).key = row_key(plan_, *task.block, method);
    if (i != done.size()) throw std::logic_error("a rank sent other rows than it was dealt");
    sweeper_.store().continue_session(worker.session.value());
    sweeper_.keep(done);
    rows_ -= done.size();
    report(static_cast<int>(rank), worker.hand, rows.seconds);
    worker.hand.clear();
  }

  void report(int rank, const std::vector<SweepTask>& hand, const std::vector<double>& seconds) {
    SweepSummary& summary = sweeper_.summary();
    ++summary.hands;
    for (std::size_t i = 0; i < hand.size(); ++i) {
      const double cost = expected_cost(plan_, *hand[i].block, hand[i].methods);
      dealt_cost_ -= cost;
      const Problem& problem = plan_.problems[hand[i].block->problem];
      summary.tasks.push_back(
          {.rank = rank,
           .problem = problem.id + (problem.material.empty() ? "" : ":" + problem.material),
           .rows = static_cast<std::int64_t>(hand[i].methods.size()),
           .expected_seconds = cost,
           .seconds = seconds.at(i)});
    }
    sweeper_.tell(1 - (deck_.cost() + dealt_cost_) / cost_,
                  fmt::format("{} ranks, {}", ranks_.size(), in_words(plan_, *hand.front().block)));
  }

  /// Where nothing is left a worker waits for its end.
  void deal(std::size_t worker, Ranks& mail, int to) {
    std::vector<SweepTask> hand = deck_.deal(measures_ ? worker : worker - 1);
    if (hand.empty()) return;
    Hand message;
    for (const SweepTask& task : hand)
      message.tasks.push_back({static_cast<std::size_t>(task.block - plan_.blocks.data()), task.methods});
    for (const SweepTask& task : hand) dealt_cost_ += expected_cost(plan_, *task.block, task.methods);
    workers_[worker].hand = std::move(hand);
    mail.send(to, to_bytes(message));
  }

  Ranks& ranks_;
  Sweeper& sweeper_;
  const SweepPlan& plan_;
  bool measures_;  ///< itself, too
  Fingerprint here_ = fingerprint();
  std::string digest_ = digest_of(plan_);
  Deck deck_;
  std::vector<Worker> workers_;                   ///< by rank; 0 is the own thread
  std::map<std::string, std::int64_t> sessions_;  ///< of other machines, by what differs
  std::size_t rows_ = 0;                          ///< not kept yet
  double cost_ = 0, dealt_cost_ = 0;              ///< expected, of all and of what is dealt
};

}  // namespace

bool are_times_rough(const SweepPlan& plan, const Ranks& ranks) {
  return plan.spec.explore || ranks.most_on_a_node() > 1;
}

SweepDealer::~SweepDealer() {
  for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.send(rank, to_bytes(Hand{}));
  int ended = 1;
  for (Pause pause; ended < ranks_.size(); pause.sleep())
    while (const auto message = ranks_.receive()) try {
        if (std::holds_alternative<RankEnded>(sweep_message(message->bytes))) ++ended;
      } catch (const std::exception&) {  // of another hmax, which ends by its own error
        ++ended;
      }
}

SweepSummary SweepDealer::run(const SweepPlan& plan, Store& store,
                              const std::function<void(const SweepProgress&)>& progress,
                              const std::function<bool()>& interrupted) {
  Sweeper sweeper(plan, store, progress, interrupted, are_times_rough(plan, ranks_));
  return sweeper.run([&](const std::vector<SweepTask>& tasks) {
    if (!tasks.empty() && !plan.spec.explore && are_times_rough(plan, ranks_))
      sweeper.warn(
          "ranks shared a node: the CPU times are approximate, and no figure or comparison takes them; one rank a node measures "
          "them (mpirun --map-by ppr:1:node)");
    Dealing(ranks_, sweeper, tasks).run();
  });
}

void help_sweep(Ranks& ranks, const std::function<SweepPlan()>& plan,
                const std::function<bool()>& interrupted) {
  Helper(ranks, interrupted).help(plan);
}

}  // namespace hmax
