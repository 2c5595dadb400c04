#include "bench/rows/model_digest.hpp"

#include <bit>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "integrators/system.hpp"

namespace hmax {

namespace {

/// FNV-1a over the bits of numbers, as of Fowler, Noll and Vo.
struct Digest {
  std::uint64_t value = 0xcbf29ce484222325;

  void add(const Eigen::VectorXd& numbers) {
    for (const double number : numbers) {
      // One NaN, whichever sign and payload it has.
      std::uint64_t bits = std::isnan(number) ? 1 : std::bit_cast<std::uint64_t>(number);
      for (int byte = 0; byte < 8; ++byte, bits >>= 8) value = (value ^ (bits & 0xff)) * 0x100000001b3;
    }
  }
};

/// A state `size` away, in another direction for each component, so that no part of a body moves rigidly.
Eigen::VectorXd moved(const Eigen::VectorXd& y, double size) {
  Eigen::VectorXd state = y;
  for (Eigen::Index i = 0; i < y.size(); ++i) state[i] += size * std::fmod(0.618033988749895 * static_cast<double>(i + 1), 1.0);
  return state;
}

}  // namespace

std::string model_digest(const Problem& problem) {
  Digest digest;
  digest.add(problem.y0);
  std::visit(
      [&]<class Sys>(const Sys& system) {
        typename Sys::State f(problem.y0);
        for (const double t : {0.0, 0.1})
          for (const double size : {0.0, 1e-6, 1e-4}) {
            const typename Sys::State y(moved(problem.y0, size));
            system.rhs(t, y, f);
            digest.add(f);
            if constexpr (SplitSystem<Sys>)
              if (hmax::has_split(problem)) {
                system.rhs_stiff(t, y, f);
                digest.add(f);
              }
          }
      },
      problem.system);
  return fmt::format("{:016x}", digest.value);
}

}  // namespace hmax
