#include "results/limits/advice_exports.hpp"

#include "results/limits/advice_columns.hpp"

namespace hmax {

namespace {

constexpr auto each_advice_column = [](const AdviceRecord& record, const auto& text, const auto& number) {
  for (const auto& column : advice_key_texts) text(column.name, record.key.*column.member);
  for (const auto& column : advice_key_numbers) number(column.name, record.key.*column.member);
  for (const auto& column : advice_texts) text(column.name, record.*column.member);
  for (const auto& column : advice_numbers) number(column.name, record.*column.member);
  number("session", static_cast<double>(record.session));
};

}  // namespace

std::string advice_to_csv(std::span<const AdviceRecord> records) {
  return columns_to_csv(records, each_advice_column);
}

std::string advice_to_jsonl(std::span<const AdviceRecord> records) {
  return columns_to_jsonl(records, each_advice_column);
}

}  // namespace hmax
