#include "cli/shared/mpirun.hpp"

#include <chrono>
#include <cstdlib>
#include <thread>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

/// The first of two variables that holds a number of at least `least`; `least` where none does.
int number_of(const char* open_mpi, const char* others, int least) {
  for (const char* variable : {open_mpi, others})
    if (const char* text = std::getenv(variable))
      if (const auto number = to_number(text); number && *number >= least && *number < 1e9)
        return static_cast<int>(*number);
  return least;
}

}  // namespace

int processes_started() { return number_of("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", 1); }

void refuse_copies(std::string_view command) {
  if (const int count = processes_started(); count > 1)
    throw InputError(fmt::format(
        "mpirun started {} copies of `{}`, which would write to the same store; start one, without mpirun",
        count, command));
}

void leave_error_to_rank_0() {
  if (processes_started() > 1 && number_of("OMPI_COMM_WORLD_RANK", "PMI_RANK", 0) > 0)
    std::this_thread::sleep_for(std::chrono::seconds(3));
}

}  // namespace hmax
