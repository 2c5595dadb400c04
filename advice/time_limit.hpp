/// The elapsed time that an answer may take.
#pragma once

#include <limits>

#include "bench/timing/timing.hpp"

namespace hmax {

/// Thrown where the time is over; what is finished by then is the answer.
struct OutOfTime {};

class TimeLimit {
 public:
  /// @param seconds  from now on
  explicit TimeLimit(double seconds = std::numeric_limits<double>::infinity()) : seconds_(seconds) {}

  [[nodiscard]] double elapsed() const { return elapsed_seconds() - begun_; }  ///< [s]
  [[nodiscard]] double left() const { return seconds_ - elapsed(); }   ///< [s], below 0 when it is over
  [[nodiscard]] double spent() const { return elapsed() / seconds_; }  ///< share; above 1 when it is over
  /// @throws OutOfTime  where more than this share of the time is over
  void require(double share = 1) const {
    if (elapsed() > share * seconds_) throw OutOfTime{};
  }

 private:
  double seconds_;
  double begun_ = elapsed_seconds();
};

}  // namespace hmax
