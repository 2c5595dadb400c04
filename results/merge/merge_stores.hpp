/// Several stores as one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "results/store.hpp"

namespace hmax {

/// Two stores have the same key with different results.
struct MergeConflict {
  std::string name;                  ///< benchmark_name() of a row, limit_name() of a limit
  std::filesystem::path file;        ///< the input whose result was left out
  std::vector<std::string> changes;  ///< from what is kept to what was left out, "steps: 1000 -> 1001"
};

struct MergeSummary {
  std::int64_t added = 0;  ///< rows, limits and answers that came in
  std::int64_t doubled =
      0;  ///< that were there already with the same results, times aside; replaced ones too
  std::vector<MergeConflict> conflicts;
};

/// Puts stores into one, in the order in which they are given: of equal keys the first counts, but a measured
/// row takes the place of an explored one with the same results. Sessions come along with their machines and
/// the time when they began. A note is kept where all stores have it with the same value. Each input goes in
/// by transactions of whole sessions, so a merge that was killed can be made again.
class Merger {
 public:
  /// @param out  stays the caller's; what it holds already counts as the first input
  explicit Merger(Store& out);
  ~Merger();

  /// @throws InputError  when `file` cannot be read or is the output, and what Store throws
  void add(const std::filesystem::path& file);

  [[nodiscard]] const MergeSummary& summary() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace hmax
