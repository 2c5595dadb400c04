/// The number of threads for the length of a test.
#pragma once

#include <cstddef>

#include "core/parallel_for.hpp"

namespace hmax {

/// So many threads as long as this lives.
class Jobs {
 public:
  explicit Jobs(std::size_t count) : before_(jobs()) { set_jobs(count); }
  ~Jobs() { set_jobs(before_); }
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

 private:
  std::size_t before_;
};

}  // namespace hmax
