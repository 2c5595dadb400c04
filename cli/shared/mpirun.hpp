/// hmax as one of many processes that mpirun has started.
#pragma once

#include <string_view>

namespace hmax {

/// How many processes mpirun started together, by OMPI_COMM_WORLD_SIZE of Open MPI or PMI_SIZE of others; 1
/// without it.
int processes_started();

/// @throws InputError  where mpirun started several: copies of a command that writes a store would write to
/// the same one
/// @param command  "hmax merge"
void refuse_copies(std::string_view command);

/// Before an error is told: sleeps for three seconds in all processes but rank 0. They have the same error,
/// and mpirun ends them a second after rank 0 has ended with its own; a process that is alone with an error
/// tells it.
void leave_error_to_rank_0();

}  // namespace hmax
