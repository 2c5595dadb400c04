/// Memory for pieces of work that run at the same time.
#pragma once

namespace hmax {

/// What all shares of this process may be together [bytes]: half of the memory of the machine.
double shared_memory();

/// A share of that memory while it lives. What does not fit beside the others waits until they have ended;
/// what is more than all goes alone. A thread holds one at a time.
class MemoryShare {
 public:
  explicit MemoryShare(double bytes);
  ~MemoryShare();
  MemoryShare(const MemoryShare&) = delete;
  MemoryShare& operator=(const MemoryShare&) = delete;

 private:
  double bytes_;
};

}  // namespace hmax
