#include "cli/shared/shard_option.hpp"

#include <fmt/format.h>

#include "cli/shared/options.hpp"
#include "core/errors.hpp"

namespace hmax {

void add_shard(CLI::App& command, std::string& shard) {
  add_text(command, "--shard", shard,
           "Measure only part I of N, like 3/8, into a store of its own; `hmax merge` makes one of all",
           "I/N");
}

std::optional<Shard> shard_from(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos)
    throw InputError(fmt::format("--shard is '{}'; write part I of N as I/N, like 3/8", text));
  const std::int64_t index = parse_count("I of --shard I/N", text.substr(0, slash), 1);
  const std::int64_t count = parse_count("N of --shard I/N", text.substr(slash + 1), 1);
  constexpr std::int64_t most = 1'000'000;
  if (index > count || count > most)
    throw InputError(
        fmt::format("--shard {} does not exist; shards count from 1 to N, and N is at most {}", text, most));
  return Shard{.index = static_cast<int>(index), .count = static_cast<int>(count)};
}

}  // namespace hmax
