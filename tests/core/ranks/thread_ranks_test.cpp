#include "core/ranks/thread_ranks.hpp"

#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

TEST(ThreadRanks, MessagesOfARankArriveInOrder) {
  constexpr int size = 4, count = 200;
  ThreadRanks ranks(size, 2);
  EXPECT_EQ(ranks[3].rank(), 3);
  EXPECT_EQ(ranks[3].size(), size);
  EXPECT_EQ(ranks[3].most_on_a_node(), 2);
  EXPECT_FALSE(ranks[0].receive().has_value());
  std::vector<std::jthread> threads;
  for (int rank = 1; rank < size; ++rank)
    threads.emplace_back([&ranks, rank] {
      for (int i = 0; i < count; ++i) ranks[rank].send(0, std::to_string(i));
    });
  std::vector<int> seen(size);
  int received = 0;
  for (Pause pause; received < (size - 1) * count; pause.sleep())
    while (const auto message = ranks[0].receive()) {
      EXPECT_EQ(message->bytes, std::to_string(seen[static_cast<std::size_t>(message->from)]++));
      ++received;
      pause.reset();
    }
  EXPECT_EQ(seen, (std::vector{0, count, count, count}));
}

TEST(ThreadRanks, BytesArriveAsTheyWereSent) {
  ThreadRanks ranks(2);
  const std::string bytes("\0\xff\n", 3);
  ranks[0].send(1, bytes);
  ranks[0].send(1, "");
  EXPECT_EQ(ranks[1].receive()->bytes, bytes);
  EXPECT_EQ(ranks[1].receive()->bytes, "");
  EXPECT_FALSE(ranks[1].receive().has_value());
}

}  // namespace
}  // namespace hmax
