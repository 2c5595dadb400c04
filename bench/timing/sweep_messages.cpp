#include "bench/timing/sweep_messages.hpp"

#include <stdexcept>

#include "results/json.hpp"

namespace hmax {

namespace {

Json to_json(const Row& row) {
  Json json;
  each_field(row, row_fields,
             [&](std::string_view name, const auto& value) { json[std::string(name)] = value; });
  return json;
}

Row row_from(const Json& json) {
  Row row;
  each_field(row, row_fields,
             [&](std::string_view name, auto& value) { json.at(std::string(name)).get_to(value); });
  return row;
}

struct ToJson {
  Json operator()(const RankReady& ready) const {
    return {{"ready", ready.sweep}, {"machine", hmax::to_json(ready.machine)}};
  }
  Json operator()(const RankRows& rows) const {
    Json list = Json::array();
    for (const Row& row : rows.rows) list.push_back(to_json(row));
    return {{"rows", std::move(list)}, {"seconds", rows.seconds}};
  }
  Json operator()(const RankFailed& failed) const {
    return {{"failed", failed.what}, {"is_input", failed.is_input}};
  }
  Json operator()(const RankInterrupted&) const { return {{"interrupted", true}}; }
  Json operator()(const Hand& hand) const {
    Json list = Json::array();
    for (const Hand::Task& task : hand.tasks) list.push_back({HMAX_KEYS(task, block, methods)});
    return {{"hand", std::move(list)}};
  }
  Json operator()(const RankEnded&) const { return {{"ended", true}}; }
};

}  // namespace

std::string to_bytes(const SweepMessage& message) {
  std::string bytes;
  Json::to_cbor(std::visit(ToJson{}, message), bytes);
  return bytes;
}

SweepMessage sweep_message(std::string_view bytes) {
  const Json json = Json::from_cbor(bytes);
  if (json.contains("ready"))
    return RankReady{json.at("ready").get<std::string>(),
                     fingerprint_from_json(json.at("machine").get<std::string>())};
  if (json.contains("rows")) {
    RankRows rows;
    for (const Json& row : json.at("rows")) rows.rows.push_back(row_from(row));
    json.at("seconds").get_to(rows.seconds);
    return rows;
  }
  if (json.contains("failed"))
    return RankFailed{json.at("failed").get<std::string>(), json.at("is_input").get<bool>()};
  if (json.contains("interrupted")) return RankInterrupted{};
  if (json.contains("hand")) {
    Hand hand;
    for (const Json& task : json.at("hand"))
      hand.tasks.push_back(
          {task.at("block").get<std::size_t>(), task.at("methods").get<std::vector<std::size_t>>()});
    return hand;
  }
  if (json.contains("ended")) return RankEnded{};
  throw std::runtime_error("a message of no known kind");
}

}  // namespace hmax
