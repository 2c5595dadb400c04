/// The header and the examples of plugins as texts, so that a user without the sources of hmax has them.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/embedded_text.hpp"

namespace hmax {

std::span<const EmbeddedText> plugin_headers();         ///< plugin.h
std::span<const EmbeddedText> plugin_step_examples();   ///< plugin_stepper.cpp
std::span<const EmbeddedText> plugin_model_examples();  ///< plugin_model.c

/// Writes hmax/plugin.h, plugin_stepper.cpp and plugin_model.c into a folder.
/// @return  the files
/// @throws InputError  where one cannot be written, or is there with another text
std::vector<std::filesystem::path> write_plugin_examples(const std::filesystem::path& folder);

}  // namespace hmax
