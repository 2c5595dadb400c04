/// The answer of `hmax advise` as one page of HTML, which needs nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/advice/advice_words.hpp"
#include "results/advice_record.hpp"

namespace hmax {

/// Writes the page.
/// @param rows   of the answer, best first
/// @param scene  the body as scene_text() writes it; empty: the problem is none, or it is too large for a
/// page
/// @throws InputError  when the page cannot be written
void write_advice_page(const std::filesystem::path& file, const AdviceText& text, const AdviceKey& question,
                       const std::vector<AdviceRecord>& rows, const std::string& scene);

}  // namespace hmax
