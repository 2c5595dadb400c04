/// Sweeps on several ranks, which are threads here.
#include "bench/timing/dealt_sweep.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "bench/timing/sweep_messages.hpp"
#include "core/errors.hpp"
#include "core/ranks/thread_ranks.hpp"
#include "results/compare.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// Rows of very unequal cost, of two problems.
SweepSpec small_sweep() {
  SweepSpec spec;
  spec.problems = {{"liver_forced", {}}, {"liver_linear", {}}};
  spec.methods = {"explicit_euler", "rk4", "bogacki_shampine_32", "dormand_prince_54"};
  spec.h = {2, 0.2, 0.1, 0.0005};
  spec.t_end = 10;
  spec.min_sample_s = 2e-5;
  return spec;
}

SweepSpec exploring() {
  SweepSpec spec = small_sweep();
  spec.explore = true;
  spec.repeats = 1;
  return spec;
}

std::vector<Row> serial_rows(const SweepSpec& spec) {
  const Scratch scratch;
  const SweepPlan plan = plan_sweep(spec);
  Store store = open_sweep_store(plan, scratch / "serial.sqlite", false);
  run_sweep(plan, store);
  return store.rows();
}

/// The same rows in the same order, but for times.
void expect_equal_rows(const std::vector<Row>& rows, const std::vector<Row>& expected) {
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].key, expected[i].key);
    for (const std::string& change : changes_between(expected[i], rows[i]))
      ADD_FAILURE() << rows[i].key.method << " " << change;
    for (const auto member :
         {&Row::error_end, &Row::error_global, &Row::error_l2, &Row::reference_error, &Row::t_reached}) {
      const double value = rows[i].*member, other = expected[i].*member;
      EXPECT_TRUE(value == other || (std::isnan(value) && std::isnan(other)))
          << rows[i].key.method << " " << value << " " << other;
    }
    EXPECT_EQ(rows[i].cpu_s.size(), expected[i].cpu_s.size());
    EXPECT_EQ(rows[i].reference, expected[i].reference);
    EXPECT_EQ(rows[i].status, expected[i].status);
    EXPECT_EQ(rows[i].subnormals, expected[i].subnormals);
  }
}

/// A rank that changes what it sends.
class Changed final : public Ranks {
 public:
  /// @param change  an empty text is not sent
  using Change = std::function<std::string(std::string_view)>;
  Changed(Ranks& ranks, Change change) : ranks_(ranks), change_(std::move(change)) {}
  [[nodiscard]] int rank() const override { return ranks_.rank(); }
  [[nodiscard]] int size() const override { return ranks_.size(); }
  [[nodiscard]] int most_on_a_node() const override { return ranks_.most_on_a_node(); }
  void send(int to, std::string_view bytes) override {
    if (const std::string changed = change_(bytes); !changed.empty()) ranks_.send(to, changed);
  }
  std::optional<Message> receive() override { return ranks_.receive(); }

 private:
  Ranks& ranks_;
  Change change_;
};

std::string unchanged(std::string_view bytes) { return std::string(bytes); }

/// Helpers in threads of their own, one for each of the ranks but 0.
class Helpers {
 public:
  Helpers(
      ThreadRanks& ranks, int size, const std::function<SweepPlan(int rank)>& plan,
      const std::function<std::string(int rank, std::string_view)>& change = [](int, std::string_view b) {
        return unchanged(b);
      }) {
    for (int rank = 1; rank < size; ++rank)
      threads_.emplace_back([&ranks, rank, plan, change] {
        Changed own(ranks[rank], [&](std::string_view bytes) { return change(rank, bytes); });
        help_sweep(own, [&] { return plan(rank); });
      });
  }

 private:
  std::vector<std::jthread> threads_;
};

SweepSummary dealt(const SweepSpec& spec, Store& store, int size, int most_on_a_node) {
  ThreadRanks ranks(size, most_on_a_node);
  const Helpers helpers(ranks, size, [&](int) { return plan_sweep(spec); });
  const SweepPlan plan = plan_sweep(spec);
  SweepDealer dealer(ranks[0]);
  return dealer.run(plan, store);
}

/// Without that of a debug build, whose times say nothing.
std::vector<std::string> warnings_of(const SweepSummary& summary) {
  std::vector<std::string> warnings = summary.warnings;
  std::erase_if(warnings,
                [](const std::string& each) { return each.find("debug build") != std::string::npos; });
  return warnings;
}

TEST(DealtSweep, HasTheRowsOfASerialSweepOnAnyNumberOfRanks) {
  for (const SweepSpec& spec : {small_sweep(), exploring()}) {
    const std::vector<Row> expected = serial_rows(spec);
    for (const int most_on_a_node : {1, 2})
      for (const int size : {2, 3, 5}) {
        const Scratch scratch;
        Store store = open_sweep_store(plan_sweep(spec), scratch / "a.sqlite", false);
        const SweepSummary summary = dealt(spec, store, size, most_on_a_node);
        EXPECT_FALSE(summary.interrupted);
        EXPECT_EQ(summary.measured, static_cast<std::int64_t>(expected.size()));
        expect_equal_rows(store.rows(), expected);
        const bool rough = spec.explore || most_on_a_node > 1;
        for (const Row& row : store.rows()) EXPECT_EQ(row.explored, rough);
        EXPECT_EQ(warnings_of(summary).empty(), !rough);
        EXPECT_EQ(summary.ranks, size);
        std::int64_t rows_of_tasks = 0;
        for (const DealtTask& task : summary.tasks) {
          rows_of_tasks += task.rows;
          EXPECT_GT(task.seconds, 0);
        }
        EXPECT_EQ(rows_of_tasks, summary.measured);
        EXPECT_LE(summary.hands, static_cast<std::int64_t>(summary.tasks.size()));
        EXPECT_EQ(store.sessions().size(), 1U);
      }
  }
}

TEST(DealtSweep, OneRankDoesAllItself) {
  for (const SweepSpec& spec : {small_sweep(), exploring()}) {
    const Scratch scratch;
    Store store = open_sweep_store(plan_sweep(spec), scratch / "a.sqlite", false);
    dealt(spec, store, 1, 1);
    expect_equal_rows(store.rows(), serial_rows(spec));
  }
}

TEST(DealtSweep, ARankThatNeverAnswersCostsItsHand) {
  const Scratch scratch;
  const SweepPlan plan = plan_sweep(small_sweep());
  Store store = open_sweep_store(plan, scratch / "a.sqlite", false);
  std::atomic<std::size_t> lost = 0;
  SweepSummary ended;
  {
    ThreadRanks ranks(3, 2);
    const Helpers helpers(
        ranks, 3, [&](int) { return plan_sweep(small_sweep()); },
        [&](int rank, std::string_view bytes) {
          const SweepMessage message = sweep_message(bytes);
          const auto* rows = std::get_if<RankRows>(&message);
          if (rank != 2 || !rows) return unchanged(bytes);
          lost = rows->rows.size();
          return std::string();
        });
    SweepDealer dealer(ranks[0]);
    // When all others are back mpirun would long have ended the job.
    ended = dealer.run(plan, store, {}, [&] {
      return lost > 0 && store.size() + static_cast<std::int64_t>(lost) == plan.rows();
    });
  }
  EXPECT_TRUE(ended.interrupted);
  EXPECT_GT(lost, 0U);
  EXPECT_EQ(store.size(), plan.rows() - static_cast<std::int64_t>(lost));
  // A serial sweep whose times are as rough takes it up.
  SweepPlan rough = plan;
  rough.spec.explore = true;
  Store again = open_sweep_store(plan, scratch / "a.sqlite", true);
  EXPECT_EQ(run_sweep(rough, again).measured, static_cast<std::int64_t>(lost));
  expect_equal_rows(again.rows(), serial_rows(small_sweep()));
}

TEST(DealtSweep, IsInterruptedAndResumed) {
  const Scratch scratch;
  const SweepPlan plan = plan_sweep(exploring());
  Store store = open_sweep_store(plan, scratch / "a.sqlite", false);
  {
    ThreadRanks ranks(2, 2);
    const Helpers helpers(ranks, 2, [&](int) { return plan_sweep(exploring()); });
    SweepDealer dealer(ranks[0]);
    EXPECT_TRUE(dealer.run(plan, store, {}, [&] { return store.size() >= 3; }).interrupted);
  }
  const std::int64_t kept = store.size();
  EXPECT_GE(kept, 3);
  EXPECT_LT(kept, plan.rows());
  const SweepSummary rest = dealt(exploring(), store, 3, 2);
  EXPECT_EQ(rest.skipped, kept);
  EXPECT_EQ(rest.measured, plan.rows() - kept);
  EXPECT_EQ(dealt(exploring(), store, 3, 2).measured, 0);
  expect_equal_rows(store.rows(), serial_rows(exploring()));
}

TEST(DealtSweep, ARankThatIsInterruptedEndsTheSweep) {
  const Scratch scratch;
  const SweepPlan plan = plan_sweep(small_sweep());
  Store store = open_sweep_store(plan, scratch / "a.sqlite", false);
  ThreadRanks ranks(2, 1);
  std::atomic<bool> some = false;
  std::jthread helper([&] {
    help_sweep(
        ranks[1], [] { return plan_sweep(small_sweep()); }, [&] { return some.load(); });
  });
  SweepDealer dealer(ranks[0]);
  const SweepSummary summary =
      dealer.run(plan, store, [&](const SweepProgress& p) { some = p.rows_done > 0; });
  EXPECT_TRUE(summary.interrupted);
  EXPECT_LT(summary.measured, plan.rows());
}

TEST(DealtSweep, RowsOfAnotherMachineAreInASessionOfTheirOwn) {
  const Scratch scratch;
  const SweepPlan plan = plan_sweep(small_sweep());
  Store store = open_sweep_store(plan, scratch / "a.sqlite", false);
  SweepSummary summary;
  {
    ThreadRanks ranks(4, 1);
    const Helpers helpers(
        ranks, 4, [&](int) { return plan_sweep(small_sweep()); },
        [](int rank, std::string_view bytes) {
          SweepMessage message = sweep_message(bytes);
          auto* ready = std::get_if<RankReady>(&message);
          if (rank == 1 || !ready) return unchanged(bytes);
          ready->machine.cpu = "another";
          return to_bytes(message);
        });
    SweepDealer dealer(ranks[0]);
    summary = dealer.run(plan, store);
  }
  const std::vector<Session> sessions = store.sessions();
  ASSERT_EQ(sessions.size(), 2U) << "two ranks are on equal machines";
  EXPECT_NE(sessions[0].fingerprint.cpu, "another");
  EXPECT_EQ(sessions[1].fingerprint.cpu, "another");
  ASSERT_EQ(warnings_of(summary).size(), 1U);
  EXPECT_TRUE(says(warnings_of(summary)[0], "another machine"));
  std::size_t of_others = 0;
  for (const Row& row : store.rows()) of_others += row.session == sessions[1].id;
  EXPECT_GT(of_others, 0U);
}

/// What a sweep on two ranks throws.
template <class Error>
std::string error_of_sweep(
    const std::function<SweepPlan(int rank)>& plan,
    const std::function<std::string(int rank, std::string_view)>& change =
        [](int, std::string_view b) { return unchanged(b); },
    int most_on_a_node = 1) {
  const Scratch scratch;
  Store store = open_sweep_store(plan_sweep(small_sweep()), scratch / "a.sqlite", false);
  ThreadRanks ranks(2, most_on_a_node);
  const Helpers helpers(ranks, 2, plan, change);
  SweepDealer dealer(ranks[0]);
  return error_of<Error>([&] {
    const SweepPlan own = plan_sweep(small_sweep());
    dealer.run(own, store);
  });
}

TEST(DealtSweep, ErrorsOfARankAreThoseOfRank0) {
  EXPECT_EQ(error_of_sweep<InputError>([](int) -> SweepPlan { throw InputError("no file here"); }),
            "rank 1: no file here");
  EXPECT_EQ(error_of_sweep<std::logic_error>([](int) -> SweepPlan { throw std::runtime_error("broken"); }),
            "rank 1: broken");
  const auto other = [](int) {
    SweepSpec spec = small_sweep();
    spec.h.back() = 0.001;
    return plan_sweep(spec);
  };
  EXPECT_TRUE(says(error_of_sweep<InputError>(other), "rank 1 has another sweep"));
  const auto shard = [](int) { return shard_of(plan_sweep(small_sweep()), {1, 2}); };
  EXPECT_TRUE(says(error_of_sweep<InputError>(shard), "rank 1 has another sweep"));
  const auto own = [](int) { return plan_sweep(small_sweep()); };
  const auto of_another_build = [](int, std::string_view bytes) {
    SweepMessage message = sweep_message(bytes);
    if (auto* ready = std::get_if<RankReady>(&message)) ready->machine.program = "another";
    return to_bytes(message);
  };
  EXPECT_TRUE(says(error_of_sweep<InputError>(own, of_another_build), "another build"));
}

TEST(DealtSweep, ARankThatIsLateIsHeardBeforeTheSweepEnds) {
  const auto late = [&](int) {
    std::this_thread::sleep_for(std::chrono::seconds(2));  // long after rank 0 has measured the last row
    SweepSpec spec = small_sweep();
    spec.h.back() = 0.001;
    return plan_sweep(spec);
  };
  // Ranks that share a node: rank 0 measures, too.
  const auto as_sent = [](int, std::string_view bytes) { return unchanged(bytes); };
  EXPECT_TRUE(says(error_of_sweep<InputError>(late, as_sent, 2), "rank 1 has another sweep"));
}

TEST(DealtSweep, AnErrorOfRank0EndsTheOthers) {
  ThreadRanks ranks(3, 2);
  const Helpers helpers(ranks, 3, [&](int) { return plan_sweep(small_sweep()); });
  // As where the store cannot be written. The helpers would never end otherwise.
  const auto fail = [&] {
    const SweepDealer dealer(ranks[0]);
    throw InputError("no room");
  };
  EXPECT_THROW(fail(), InputError);
}

TEST(SweepMessages, KeepEveryBitOfARow) {
  Row row;
  row.outcome = "diverged";
  row.t_reached = 0.1;
  row.steps = std::numeric_limits<std::int64_t>::max();
  row.rejected = 3;
  row.rhs = 4;
  row.cpu_s = {0.1, 1e-300, std::numeric_limits<double>::denorm_min()};
  row.runs_per_sample = 5;
  row.error_end = std::numeric_limits<double>::quiet_NaN();
  row.error_global = std::numeric_limits<double>::infinity();
  row.error_l2 = 1 / 3.0;
  row.reference_error = -0.0;
  row.reference = "exact";
  row.subnormals = 6;
  row.status = "byte \xff";
  row.explored = true;
  const SweepMessage message = sweep_message(to_bytes(RankRows{{row, Row{}}, {0.25, 0.5}}));
  const auto& rows = std::get<RankRows>(message).rows;
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(std::get<RankRows>(message).seconds, (std::vector{0.25, 0.5}));
  const Row& back = rows[0];
  EXPECT_EQ(back.outcome, row.outcome);
  EXPECT_EQ(back.t_reached, row.t_reached);
  EXPECT_EQ(back.steps, row.steps);
  EXPECT_EQ(back.rejected, row.rejected);
  EXPECT_EQ(back.rhs, row.rhs);
  EXPECT_EQ(back.cpu_s, row.cpu_s);
  EXPECT_EQ(back.runs_per_sample, row.runs_per_sample);
  EXPECT_TRUE(std::isnan(back.error_end));
  EXPECT_EQ(back.error_global, row.error_global);
  EXPECT_EQ(back.error_l2, row.error_l2);
  EXPECT_TRUE(back.reference_error == 0 && std::signbit(back.reference_error));
  EXPECT_EQ(back.reference, row.reference);
  EXPECT_EQ(back.subnormals, row.subnormals);
  EXPECT_EQ(back.status, row.status);
  EXPECT_TRUE(back.explored);
}

TEST(SweepMessages, OtherBytesAreRefused) {
  for (const char* bytes : {"", "x", "\xa0", "\xa1\x61x\x01"})
    EXPECT_ANY_THROW(sweep_message(bytes)) << bytes;
}

}  // namespace
}  // namespace hmax
