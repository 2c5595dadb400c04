/// The answer of `hmax advise` as one page of HTML, which needs nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "advice/motion/motion_limits.hpp"
#include "cli/advice/advice_words.hpp"
#include "plots/pages/body_scene.hpp"
#include "results/advice_record.hpp"

namespace hmax {

/// Writes the page.
/// @param rows   of the answer, best first
/// @param scene  the body as scene_text() writes it; empty: the problem is none, or it is too large for a
/// page
/// @throws InputError  when the page cannot be written
void write_advice_page(const std::filesystem::path& file, const AdviceText& text, const AdviceKey& question,
                       const std::vector<AdviceRecord>& rows, const std::string& scene);

/// A body on its probing motion, with the fastest mode at rest, which limits explicit steps, and the slowest
/// at the start of the motion where it takes no longer than a second.
/// @param model  of a body: AnalysedModel::motion has one
/// @returns JSON of scene_text(); empty for a body whose surface is too large for a page
std::string body_scene_text(const AnalysedModel& model);

}  // namespace hmax
