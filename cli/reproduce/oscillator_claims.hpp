/// Sections of the report on the liver study that test its words.
#pragma once

#include <string>
#include <vector>

#include "plots/pages/report.hpp"
#include "results/row.hpp"

namespace hmax {

/// Each sentence that can be tested, beside what runs show.
/// @param rows  as claims_on_solvers()
ReportSection claims_section(const std::vector<Row>& rows);

/// The solvers of the study at MATLAB's default tolerances and step control, beside those of the other
/// sections.
ReportSection defaults_section();

}  // namespace hmax
