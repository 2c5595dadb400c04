/// Tests of hmax under mpirun of Open MPI, where it is there.
#pragma once

#include <string>
#include <string_view>

#include "tests/cli/program.hpp"

namespace hmax {

/// Whether this build has an optional library, by its name in `hmax doctor`.
inline bool is_built_with(std::string_view library) {
  const nlohmann::json report = Shell().hmax("doctor --json").json();
  for (const nlohmann::json& part : report.at("optional"))
    if (part.at("name") == library) return part.at("present");
  return false;
}

/// What a line with Open MPI begins with: it starts as root only when it is told to, and ends with memory of
/// its own that sanitizers report as leaked.
inline const std::string with_mpi =
    "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 LSAN_OPTIONS=detect_leaks=0; ";
/// Starts two processes, also on one core.
inline const std::string mpirun_two = "mpirun -n 2 --oversubscribe ";

inline bool starts_two_processes() {
  return Shell().line(with_mpi + "timeout 60 " + mpirun_two + "true").exit_code == 0;
}

}  // namespace hmax
