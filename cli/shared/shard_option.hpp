/// --shard I/N of commands that measure into a store.
#pragma once

#include <optional>
#include <string>

#include "bench/timing/sweep.hpp"
#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"

namespace hmax {

void add_shard(CLI::App& command, std::string& shard);

/// "3/8"; nothing where the option is not given.
/// @throws InputError  for another form, and shards that do not exist
std::optional<Shard> shard_from(const std::string& text);

}  // namespace hmax
