#include <algorithm>
#include <thread>

#include "core/input_error.hpp"
#include "core/ranks/module.hpp"
#include "core/ranks/ranks.hpp"

namespace hmax {

void Pause::sleep() {
  std::this_thread::sleep_for(next_);
  next_ = std::min(2 * next_, longest);
}

bool has_mpi() { return HMAX_HAVE_MPI; }

std::unique_ptr<Ranks> open_ranks(int started) {
  if (!has_mpi())
    throw input_error(
        "mpirun started {} processes, and this hmax was built without MPI; install the Debian packages "
        "libopenmpi-dev and openmpi-bin, then configure and build again, or divide the sweep with --shard",
        started);
  void* const symbol = symbol_of_module("hmax_mpi.so", make_ranks_symbol);
  std::unique_ptr<Ranks> ranks = reinterpret_cast<MakeRanks>(symbol)(started);
  if (!ranks)
    throw input_error(
        "{} processes were started by another mpirun than that of Open MPI, which this hmax was built with; take "
        "that one",
        started);
  return ranks;
}

}  // namespace hmax
