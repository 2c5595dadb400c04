// A store against the world: kills, other processes, other programs' files, missing rights, full disks.
#include <algorithm>
#include <chrono>
#include <fcntl.h>
#include <functional>
#include <random>
#include <set>
#include <signal.h>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "core/errors.hpp"
#include "results/patience.hpp"
#include "results/store.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

Row numbered_row(int number) {
  Row r;
  r.key.problem = "dahlquist";
  r.key.method = "rk4";
  r.key.mode = "fixed";
  r.key.h = number;
  r.outcome = "reached_end";
  r.cpu_s = {1e-3, 2e-3};
  return r;
}

/// Runs `work` in a child; its return value is the exit code.
pid_t in_child(const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    int code = 99;
    try {
      code = work();
    } catch (const std::exception& error) {
      fprintf(stderr, "child: %s\n", error.what());
    }
    _exit(code);
  }
  return child;
}

int exit_code(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void foreign_sql(const std::filesystem::path& file, const char* sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
  sqlite3_close(database);
}

TEST(StoreProcess, AKillAtAnyMomentLosesNothingInsertedAndLeavesNothingHalfDone) {
  Scratch scratch;
  const auto file = scratch / "a.sqlite";
  std::mt19937 random(7);
  constexpr int batch = 3;
  for (int kill_number = 0; kill_number < 25; ++kill_number) {
    int pipe_ends[2];
    ASSERT_EQ(pipe(pipe_ends), 0);
    const pid_t child = in_child([&] {
      close(pipe_ends[0]);
      Store store = Store::open_or_create(file);
      store.begin_session({});
      for (int group = 0;; ++group) {
        std::vector<Row> rows;
        for (int i = 0; i < batch; ++i) rows.push_back(numbered_row(group * batch + i));
        if (store.contains(rows[0].key)) continue;
        store.insert(rows);
        // Only after insert() returned: whatever the parent reads here must be in the store.
        if (write(pipe_ends[1], &group, sizeof group) != sizeof group) return 1;
      }
    });
    close(pipe_ends[1]);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 30000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    int acknowledged = -1;
    for (int group; read(pipe_ends[0], &group, sizeof group) == sizeof group;) acknowledged = group;
    close(pipe_ends[0]);

    const Store store = Store::open_or_create(file);
    std::set<double> seen;
    for (const Row& r : store.rows()) EXPECT_TRUE(seen.insert(r.key.h).second);
    EXPECT_EQ(seen.size() % batch, 0u) << "a transaction was stored in part";
    EXPECT_GE(static_cast<int>(seen.size()), (acknowledged + 1) * batch);
    EXPECT_EQ(seen.empty() ? -1 : *seen.rbegin(), static_cast<double>(seen.size()) - 1) << "a row was lost";
  }
  EXPECT_GT(Store::open_existing(file).size(), 0);
}

TEST(StoreProcess, ManyProcessesCreateAndFillOneStoreAtTheSameTime) {
  Scratch scratch;
  const auto file = scratch / "a.sqlite";
  constexpr int processes = 6, each = 40;
  std::vector<pid_t> children;
  for (int p = 0; p < processes; ++p) {
    children.push_back(in_child([&, p] {
      Store store = Store::open_or_create(file);
      store.begin_session({});
      for (int i = 0; i < each; ++i) store.insert(numbered_row(p * each + i));
      return 0;
    }));
  }
  for (const pid_t child : children) EXPECT_EQ(exit_code(child), 0);
  const Store store = Store::open_existing(file);
  EXPECT_EQ(store.size(), processes * each);
  EXPECT_EQ(store.sessions().size(), static_cast<std::size_t>(processes));
}

TEST(StoreProcess, ARowThatAnotherProcessStoredMeanwhileIsAnInputError) {
  Scratch scratch;
  Store first = Store::open_or_create(scratch / "a"), second = Store::open_or_create(scratch / "a");
  first.begin_session({});
  second.begin_session({});
  first.insert(numbered_row(1));
  EXPECT_TRUE(says(error_of<InputError>([&] { second.insert(numbered_row(1)); }), "Another process"));
  second.insert(numbered_row(2));
  EXPECT_EQ(first.size(), 2);
  EXPECT_EQ(first.rows()[0].session, 2);  // h descends
}

TEST(StoreProcess, ExploredRowsAreNotMeasured) {
  Scratch scratch;
  Store store = Store::open_or_create(scratch / "a");
  store.begin_session({});
  store.insert(numbered_row(1));
  Row explored = numbered_row(2);
  explored.explored = true;
  store.insert(explored);
  EXPECT_TRUE(store.contains_measured(numbered_row(1).key));
  EXPECT_TRUE(store.contains(explored.key));
  EXPECT_FALSE(store.contains_measured(explored.key));
  EXPECT_FALSE(store.contains_measured(numbered_row(3).key));
  EXPECT_EQ(std::ranges::count_if(store.rows(), &Row::explored), 1);
}

TEST(StoreProcess, WithoutRightsReadingWorksAndWritingIsRefused) {
  for (const mode_t folder_mode : {0555, 0777}) {
    Scratch scratch;
    const auto folder = scratch / "runs";
    std::filesystem::create_directory(folder);
    {
      Store store = Store::open_or_create(folder / "old");
      store.begin_session({});
      store.insert(numbered_row(1));
    }
    const std::string before = read_text(folder / "old");
    chmod((folder / "old").c_str(), 0444);
    chmod(folder.c_str(), folder_mode);
    chmod(scratch.folder().c_str(), 0755);
    const int code = exit_code(in_child([&] {
      if (geteuid() == 0 && setuid(65534) != 0) return 77;  // root writes anywhere: become nobody
      Store store = Store::open_existing(folder / "old");
      const std::vector<Row> rows = store.rows();
      if (rows.size() != 1 || !(rows[0].key == numbered_row(1).key)) return 1;
      if (!store.contains(numbered_row(1).key) || store.sessions().size() != 1) return 2;
      const auto refuses = [&](const char* name, const char* words) {
        return says(error_of<InputError>([&] { Store::open_or_create(folder / name); }), words);
      };
      if (folder_mode == 0555 && !refuses("new", "writable")) return 3;
      if (folder_mode == 0555 && !refuses("deep/new", "folder")) return 4;
      if (folder_mode == 0555 && !refuses("old", "read-only")) return 5;
      return says(error_of<InputError>([&] { store.begin_session({}); }), "read-only") ? 0 : 6;
    }));
    chmod(folder.c_str(), 0755);
    if (code == 77) GTEST_SKIP() << "cannot give up root";
    EXPECT_EQ(code, 0);
    EXPECT_EQ(read_text(folder / "old"), before);
  }
}

TEST(StoreProcess, AnotherSchemaOrApplicationIsRefusedAndLeftUntouched) {
  Scratch scratch;
  {
    Store store = Store::open_or_create(scratch / "old");
    store.begin_session({});
    store.insert(numbered_row(1));
  }
  foreign_sql(scratch / "old", "PRAGMA user_version = 77");
  foreign_sql(scratch / "other", "CREATE TABLE addresses (name TEXT); INSERT INTO addresses VALUES ('x')");
  for (const char* name : {"old", "other"}) {
    const std::string before = read_text(scratch / name);
    EXPECT_TRUE(says(error_of<InputError>([&] { Store::open_or_create(scratch / name); }), name));
    EXPECT_TRUE(says(error_of<InputError>([&] { Store::open_existing(scratch / name); }), "untouched"));
    EXPECT_EQ(read_text(scratch / name), before);
  }
  EXPECT_TRUE(says(error_of<InputError>([&] { Store::open_existing(scratch / "old"); }), "schema 77"));
}

TEST(StoreProcess, ALockedStoreIsAnInputErrorAfterAShortWait) {
  Scratch scratch;
  Store store = Store::open_or_create(scratch / "a");
  store.begin_session({});
  store.insert(numbered_row(1));
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open((scratch / "a").c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_TRUE(says(error_of<InputError>([&] { store.insert(numbered_row(2)); }), "locked"));
  EXPECT_EQ(store.size(), 1);
  sqlite3_close(other);
  store.insert(numbered_row(2));
  EXPECT_EQ(store.size(), 2);
}

TEST(StoreProcess, ALockedStoreIsWaitedForAsLongAsAsked) {
  static int told;
  told = 0;
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "a");
  store.begin_session({});
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open((scratch / "a").c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  set_patience({.milliseconds = 60000, .tell = [](std::string_view) { ++told; }});
  {
    const std::jthread lets_go([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(2500));
      sqlite3_close(other);
    });
    store.insert(numbered_row(1));
  }
  set_patience({});
  EXPECT_EQ(told, 1);
  EXPECT_EQ(store.size(), 1);
}

TEST(StoreProcess, AFullDiskIsAnInputErrorAndKeepsWhatWasStored) {
  Scratch scratch;
  const auto file = scratch / "a";
  const int code = exit_code(in_child([&] {
    signal(SIGXFSZ, SIG_IGN);
    Store store = Store::open_or_create(file);
    store.begin_session({});
    store.insert(numbered_row(0));
    const rlimit limit{400000, 400000};
    setrlimit(RLIMIT_FSIZE, &limit);
    int stored = 1;
    const std::string words = error_of<InputError>([&] {
      for (;; ++stored) {
        Row big = numbered_row(stored);
        big.status = std::string(5000, 'x');
        store.insert(big);
      }
    });
    if (words.find("free some space") == std::string::npos) {
      fprintf(stderr, "%s\n", words.c_str());
      return 1;
    }
    return store.size() == stored && stored > 10 ? 0 : 2;
  }));
  EXPECT_EQ(code, 0);
  Store store = Store::open_or_create(file);
  EXPECT_GT(store.size(), 10);
  store.begin_session({});
  store.insert(numbered_row(100000));
}

}  // namespace
}  // namespace hmax
