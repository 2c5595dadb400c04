#include "plots/pages/answer_words.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"
#include "results/json.hpp"

namespace hmax {

std::string answer_text(const AnswerWords& words) {
  const Json document{{"version", 1}, HMAX_KEYS(words, body, facts, help, remedies)};
  return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

AnswerWords answer_words_of(std::string_view text) {
  try {
    const Json document = Json::parse(text);
    AnswerWords words;
    document.at("body").get_to(words.body);
    document.at("facts").get_to(words.facts);
    document.at("help").get_to(words.help);
    document.at("remedies").get_to(words.remedies);
    return words;
  } catch (const Json::exception& error) {
    throw InputError(
        fmt::format("the stored words of an answer are damaged ({}); ask `hmax advise` again", error.what()));
  }
}

}  // namespace hmax
