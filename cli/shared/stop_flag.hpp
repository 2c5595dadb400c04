/// How a task that saves its state is told to end.
#pragma once

namespace hmax {

/// While one lives, Ctrl-C, SIGTERM and SIGHUP set a flag in place of ending the program: for a task that
/// saves its state before it ends. A second signal ends the program at once.
class StopFlag {
 public:
  StopFlag();
  ~StopFlag();
  StopFlag(const StopFlag&) = delete;
  StopFlag& operator=(const StopFlag&) = delete;

  [[nodiscard]] bool is_set() const;
};

}  // namespace hmax
