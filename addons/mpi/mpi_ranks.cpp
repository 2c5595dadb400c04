/// Ranks by MPI. A module of its own, opened in processes that mpirun has started.
#include <cstddef>
#include <mpi.h>

#include "core/ranks/ranks.hpp"
#include "core/ranks/silence.hpp"

namespace hmax {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

/// An error of MPI ends all ranks, as MPI does by default.
class MpiRanks final : public Ranks {
 public:
  MpiRanks() {
    // Measuring threads do not call MPI.
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(world, &rank_);
    MPI_Comm_size(world, &size_);
    MPI_Comm node = MPI_COMM_NULL;
    MPI_Comm_split_type(world, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
    MPI_Comm_size(node, &most_on_a_node_);
    MPI_Comm_free(&node);
    MPI_Allreduce(MPI_IN_PLACE, &most_on_a_node_, 1, MPI_INT, MPI_MAX, world);
    if (rank_ > 0) static_cast<void>(silence_standard_streams());
  }
  ~MpiRanks() override { MPI_Finalize(); }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }
  [[nodiscard]] int most_on_a_node() const override { return most_on_a_node_; }

  void send(int to, std::string_view bytes) override {
    MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, 0, world);
  }

  std::optional<Message> receive() override {
    int is_there = 0, length = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, 0, world, &is_there, &status);
    if (!is_there) return std::nullopt;
    MPI_Get_count(&status, MPI_BYTE, &length);
    Message message{.from = status.MPI_SOURCE, .bytes = std::string(static_cast<std::size_t>(length), '\0')};
    MPI_Recv(message.bytes.data(), length, MPI_BYTE, message.from, 0, world, MPI_STATUS_IGNORE);
    return message;
  }

 private:
  int rank_ = 0, size_ = 1, most_on_a_node_ = 1;
};

}  // namespace
}  // namespace hmax

// NOLINTNEXTLINE(readability-identifier-naming): found by its name
extern "C" __attribute__((visibility("default"))) std::unique_ptr<hmax::Ranks> hmax_make_ranks(int started) {
  auto ranks = std::make_unique<hmax::MpiRanks>();
  if (ranks->size() != started) return nullptr;
  return ranks;
}
