/// An answer of `hmax advise` in words, as stores keep it for `hmax report`.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hmax {

/// What the rows of an answer do not tell.
struct AnswerWords {
  std::string body = {};  ///< what a body is made of; empty of what is none
  /// Of what is recommended: names and words; what has no name goes on with the last.
  std::vector<std::pair<std::string, std::string>> facts = {};
  std::string help = {};                   ///< what is said of remedies; empty where none were sought
  std::vector<std::string> remedies = {};  ///< one change each

  bool operator==(const AnswerWords&) const = default;
};

/// One JSON object for stores. Bytes that are not UTF-8 become U+FFFD.
std::string answer_text(const AnswerWords& words);

/// The words back. @throws InputError  where the text is malformed
AnswerWords answer_words_of(std::string_view text);

}  // namespace hmax
