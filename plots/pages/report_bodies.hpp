/// The bodies of stored answers as a section of a page.
#pragma once

#include <span>
#include <string>

#include "plots/pages/reported_store.hpp"

namespace hmax {

/// Each body once, as long as there is room; how many have none is told. Empty without a body.
/// @returns HTML, for a page with the style and the script of plots/pages/body_scene.hpp
std::string report_bodies(std::span<const ReportedStore> stores);

}  // namespace hmax
