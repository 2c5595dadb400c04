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

/// Starts two processes. Open MPI starts as root, and more processes than cores, only when it is told to; the
/// words export what it is told to the whole line.
inline const std::string as_root = "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; ";
inline const std::string mpirun_two = "mpirun -n 2 --oversubscribe ";

inline bool starts_two_processes() {
  return Shell().line(as_root + "timeout 60 " + mpirun_two + "true").exit_code == 0;
}

}  // namespace hmax
