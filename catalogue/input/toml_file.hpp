/// TOML files of users, read with care and handed on as JSON values that remember their lines.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hmax {

/// The content of a TOML file. Places in it are JSON pointers: "" is the whole file, "/sweep/step" the key
/// `step` of [sweep], "/a/1" the second element of the array `a`.
struct TomlDocument {
  std::string name;  ///< the file as the user wrote it
  nlohmann::ordered_json
      root;  ///< an object; keys in the order of the file; integers, numbers (also inf and nan)
  std::map<std::string, int> lines{};  ///< place -> line, from 1

  /// The line of a place, or of the nearest place around it; 0 for the file as a whole.
  [[nodiscard]] int line(std::string_view place) const;
  /// Throws InputError "name:line: message".
  [[noreturn]] void fail(std::string_view place, std::string_view message) const;
  /// @param message  as of fmt::format()
  template <class First, class... T>
  [[noreturn]] void fail(std::string_view place, fmt::format_string<First, T...> message, First&& first,
                         T&&... values) const {
    fail(place, fmt::format(message, std::forward<First>(first), std::forward<T>(values)...));
  }
};

/// Reads a TOML file of at most 1 MiB in UTF-8.
/// @throws InputError naming file and line when it cannot be opened, is too large, is not UTF-8, holds
/// control bytes,
///         dates, or anything that is not TOML
TomlDocument read_toml(const std::filesystem::path& path);

/// The same for text at hand; `name` stands for the file in messages.
TomlDocument parse_toml(std::string_view text, std::string name);

/// Throws InputError "sweep.toml:3: unknown key 'stpe' in [sweep]; did you mean 'step'?" when the table at
/// `place` holds a key that is not in `allowed`, or when `place` is there but is not a table. An absent place
/// is accepted.
void reject_unknown_keys(const TomlDocument& document, std::string_view place,
                         std::span<const std::string_view> allowed);

}  // namespace hmax
