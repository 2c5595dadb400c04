/// "Did you mean ...?": the known name nearest to a mistyped one, and the words that offer it.
#pragma once

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hmax {

/// The number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b` (optimal
/// string alignment); letter case counts for nothing, and '-' is '_'.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  auto folded = [](char c) {
    return c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  };
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const bool same = folded(a[i]) == folded(b[j]);
      row[j + 1] = std::min({last[j] + (same ? 0 : 1), last[j + 1] + 1, row[j] + 1});
      const bool swapped =
          i > 0 && j > 0 && folded(a[i]) == folded(b[j - 1]) && folded(a[i - 1]) == folded(b[j]);
      if (swapped) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
    before = last;
    last = row;
  }
  return last[b.size()];
}

/// The name nearest to `wrong`, or an empty string when none is near: the shortest that begins with it (at
/// least three characters), or else that of the fewest edits, at most one in three characters.
/// @param names  any range of strings
template <class Names>
std::string did_you_mean(std::string_view wrong, const Names& names) {
  constexpr std::size_t longest = 100;  // a name longer than this is no slip of the finger
  if (wrong.empty() || wrong.size() > longest) return {};
  std::string best;
  for (const auto& name : names) {
    const std::string_view whole = name;
    if (wrong.size() >= 3 && edit_distance(wrong, whole.substr(0, wrong.size())) == 0 &&
        (best.empty() || whole.size() < best.size()))
      best = whole;
  }
  if (!best.empty()) return best;
  std::size_t smallest = std::max<std::size_t>(1, wrong.size() / 3) + 1;
  for (const auto& name : names) {
    const std::size_t distance = edit_distance(wrong, name);
    if (distance < smallest && distance < std::string_view(name).size()) {
      smallest = distance;
      best = name;
    }
  }
  return best;
}

/// The remedy in an error about a name: "did you mean 'rk4'?", of several that are as near "'cpu' or 'gpu'?",
/// or `otherwise` when none is near.
template <class Names>
std::string suggestion(std::string_view wrong, const Names& names, std::string_view otherwise) {
  const std::string near = did_you_mean(wrong, names);
  if (near.empty()) return std::string(otherwise);
  const std::size_t edits = edit_distance(wrong, near);
  std::string all = fmt::format("'{}'", near);
  if (edits <= std::max<std::size_t>(1, wrong.size() / 3))  // no beginning that is completed
    for (const auto& name : names)
      if (name != near && edit_distance(wrong, name) == edits) all += fmt::format(" or '{}'", name);
  return fmt::format("did you mean {}?", all);
}

/// The same with the names themselves, "known are rk4, leapfrog", when none is near.
template <class Names>
std::string suggestion(std::string_view wrong, const Names& names) {
  return suggestion(
      wrong, names,
      std::empty(names) ? "there are none" : fmt::format("known are {}", fmt::join(names, ", ")));
}

}  // namespace hmax
