/// JSON documents, whose keys keep their order.
#pragma once

#include <nlohmann/json.hpp>

#include "results/fields.hpp"

namespace hmax {

using Json = nlohmann::ordered_json;

}  // namespace hmax

/// Members of a value under their names, for the list that makes an object: {HMAX_KEYS(row, h, error), ...}.
#define HMAX_KEYS(value, ...) HMAX_EXPAND(HMAX_EACH(HMAX_KEY, value, __VA_ARGS__))
#define HMAX_KEY(value, name) \
  { #name, (value).name }

/// HMAX_RECORD(Type, member, ...): a struct as an object of these members; a vector of them is an array.
#define HMAX_RECORD(Type, ...)                                                                     \
  inline void to_json(Json& json, const Type& record) { json = {HMAX_KEYS(record, __VA_ARGS__)}; } \
  static_assert(true, "a semicolon follows")
