/// Ranks that are threads of one process.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "core/ranks/ranks.hpp"

namespace hmax {

/// Mailboxes of some ranks. It must outlive the threads that use them.
class ThreadRanks {
 public:
  /// @param most_on_a_node  what Ranks::most_on_a_node() says
  explicit ThreadRanks(int size, int most_on_a_node = 1);
  ~ThreadRanks();
  ThreadRanks(const ThreadRanks&) = delete;
  ThreadRanks& operator=(const ThreadRanks&) = delete;

  /// For the thread that is this rank.
  Ranks& operator[](int rank);

 private:
  class One;
  std::mutex lock_;
  std::vector<std::deque<Message>> boxes_;  ///< under the lock
  std::vector<std::unique_ptr<One>> ranks_;
};

}  // namespace hmax
