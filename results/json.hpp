/// JSON documents, whose keys keep their order.
#pragma once

#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

#include "results/fields.hpp"

namespace hmax {

using Json = nlohmann::ordered_json;

/// Null for what there is not: an empty text, an optional without a value.
inline Json json_or_null(std::string_view text) { return text.empty() ? Json() : Json(text); }
template <class Value>
Json json_or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace hmax

/// Members of a value under their names, for the list that makes an object: {HMAX_KEYS(row, h, error), ...}.
#define HMAX_KEYS(value, ...) HMAX_EXPAND(HMAX_EACH(HMAX_KEY, value, __VA_ARGS__))
#define HMAX_KEY(value, name) \
  { #name, (value).name }

/// HMAX_RECORD(Type, member, ...): a struct as an object of these members; a vector of them is an array.
#define HMAX_RECORD(Type, ...)                                                                     \
  inline void to_json(Json& json, const Type& record) { json = {HMAX_KEYS(record, __VA_ARGS__)}; } \
  static_assert(true, "a semicolon follows")
