#include "core/ranks/thread_ranks.hpp"

#include <cstddef>
#include <utility>

namespace hmax {

class ThreadRanks::One final : public Ranks {
 public:
  One(ThreadRanks& all, int rank, int most_on_a_node)
      : all_(all), rank_(rank), most_on_a_node_(most_on_a_node) {}

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return static_cast<int>(all_.boxes_.size()); }
  [[nodiscard]] int most_on_a_node() const override { return most_on_a_node_; }

  void send(int to, std::string_view bytes) override {
    const std::scoped_lock lock(all_.lock_);
    all_.boxes_.at(static_cast<std::size_t>(to)).push_back({rank_, std::string(bytes)});
  }

  std::optional<Message> receive() override {
    const std::scoped_lock lock(all_.lock_);
    std::deque<Message>& box = all_.boxes_[static_cast<std::size_t>(rank_)];
    if (box.empty()) return std::nullopt;
    Message message = std::move(box.front());
    box.pop_front();
    return message;
  }

 private:
  ThreadRanks& all_;
  int rank_, most_on_a_node_;
};

ThreadRanks::ThreadRanks(int size, int most_on_a_node) : boxes_(static_cast<std::size_t>(size)) {
  for (int rank = 0; rank < size; ++rank)
    ranks_.push_back(std::make_unique<One>(*this, rank, most_on_a_node));
}
ThreadRanks::~ThreadRanks() = default;

Ranks& ThreadRanks::operator[](int rank) { return *ranks_.at(static_cast<std::size_t>(rank)); }

}  // namespace hmax
