/// Standard streams of processes that do not speak.
#pragma once

#include <fcntl.h>
#include <unistd.h>

namespace hmax {

/// Standard output and error of this process go to the null device from now on.
/// @returns a descriptor of standard error as it was
inline int silence_standard_streams() {
  const int error = dup(STDERR_FILENO);
  const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(null, STDOUT_FILENO);
  dup2(null, STDERR_FILENO);
  close(null);
  return error;
}

}  // namespace hmax
