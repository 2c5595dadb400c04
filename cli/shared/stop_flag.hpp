/// How a task that saves its state is told to end.
#pragma once

#include <atomic>

namespace hmax {

/// interrupt_flag() of a task that saves its state before it ends: from the first call on SIGTERM and SIGHUP
/// set it too. A second signal ends the program at once.
const std::atomic<bool>& stop_flag();

}  // namespace hmax
