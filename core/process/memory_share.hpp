/// Memory for pieces of work that run at the same time.
#pragma once

namespace hmax {

/// About what a sparse factor of so many rows takes in three dimensions [bytes], measured on balls.
double bytes_of_factor(double rows);

/// What all shares of this process may be together [bytes]: half of the memory of the machine.
double shared_memory();

/// A share of that memory while it lives. What does not fit beside the others waits until they have ended;
/// what is more than all goes alone. A thread holds one at a time.
/// Admission control for parallel work: waits in the constructor, gives back in the destructor. Nothing is
/// allocated; the figure is the caller's estimate.
class MemoryShare {
 public:
  /// Blocks until no share is held, or until the shares held and this one fit into shared_memory()
  /// together. A thread that already holds one may wait for itself for ever.
  /// @param bytes  the estimate, >= 0
  explicit MemoryShare(double bytes);
  /// Gives the share back and wakes all that wait.
  ~MemoryShare();
  MemoryShare(const MemoryShare&) = delete;
  MemoryShare& operator=(const MemoryShare&) = delete;

 private:
  // What the destructor gives back.
  double bytes_;
};

}  // namespace hmax
