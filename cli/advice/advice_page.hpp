/// The answer of `hmax advise` as one page of HTML, which needs nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/advice/advice_words.hpp"
#include "results/advice_record.hpp"

namespace hmax {

/// Draws the figures of the rows and writes the page.
/// @param rows      of the answer, best first
/// @param error_of  what errors are relative to
/// @returns why figures are missing, as one sentence; empty where all are drawn
/// @throws InputError  when the page cannot be written
std::string write_advice_page(const std::filesystem::path& file, const AdviceText& text,
                              const AdviceKey& question, const std::vector<AdviceRecord>& rows,
                              const std::string& error_of);

}  // namespace hmax
