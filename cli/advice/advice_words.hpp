/// The answer of `hmax advise` in words: what the text and the page both show.
#pragma once

#include <string>
#include <vector>

#include "advice/advise.hpp"
#include "cli/shared/console.hpp"
#include "plots/pages/answer_words.hpp"

namespace hmax {

/// An answer, sentence by sentence.
struct AdviceText : AnswerWords {
  std::string model;     ///< id of the problem, and its material
  std::string motion;    ///< by which steps are judged
  std::string question;  ///< rate, tolerance and budget
  std::string answer;    ///< what to take; that nothing suits; or how far a search got that ended early
  std::vector<std::vector<std::string>> table;  ///< every row, under its headings
  std::vector<std::string> reasons;             ///< why rows do not suit, each reason once
  std::vector<std::string> notes;               ///< on the dashes of the table
  std::string left_out;                         ///< methods that were not tried; empty where all were
  std::string machine;                          ///< that the times are of
};

/// The words of an answer; AdviceText::left_out is left.
/// @param interrupted  the search was: what is recommended is not verified, or not every remedy was tried
AdviceText words_of(const Problem& problem, const AdviceQuestion& question, const Advice& advice,
                    bool interrupted);

/// The rows as they are before the motion is run, in words for people who wait.
std::string words_of_first_answer(const Problem& problem, const AdviceQuestion& question,
                                  const Advice& advice, const Console& console);

/// The text of the command.
std::string for_people(const AdviceText& text, const Console& console);

}  // namespace hmax
