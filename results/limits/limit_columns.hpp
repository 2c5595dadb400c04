/// The columns of stored limits: one list for the tables of a store, for what is written to and read from
/// them, and for the exports. A change of the list is another layout, see Store::schema_version.
#pragma once

#include <array>

#include "results/limit_row.hpp"
#include "results/limits/columns.hpp"

namespace hmax {

inline constexpr std::array<Column<OperatingPointKey, std::string>, 7> point_key_texts{
    {{"problem", &OperatingPointKey::problem},
     {"material", &OperatingPointKey::material},
     {"parameters", &OperatingPointKey::parameters},
     {"y0", &OperatingPointKey::y0},
     {"model", &OperatingPointKey::model},
     {"asked", &OperatingPointKey::asked},
     {"path", &OperatingPointKey::path}}};

inline constexpr std::array<Column<OperatingPointRow, std::string>, 1> point_texts{
    {{"document", &OperatingPointRow::document}}};

inline constexpr std::array<Column<LimitRow, std::string>, 9> limit_texts{
    {{"method", &LimitRow::method},
     {"bound", &LimitRow::bound},
     {"state_kind", &LimitRow::state_kind},
     {"state", &LimitRow::state},
     {"newton", &LimitRow::newton},
     {"verdict", &LimitRow::verdict},
     {"path_note", &LimitRow::path_note},
     {"note", &LimitRow::note},
     {"details", &LimitRow::details}}};

inline constexpr std::array<Column<LimitRow, double>, 21> limit_numbers{
    {{"h_max", &LimitRow::h_max},
     {"h_unstable", &LimitRow::h_unstable},
     {"re", &LimitRow::re},
     {"im", &LimitRow::im},
     {"omega", &LimitRow::omega},
     {"zeta", &LimitRow::zeta},
     {"rate_slow", &LimitRow::rate_slow},
     {"rate_fast", &LimitRow::rate_fast},
     {"newton_h", &LimitRow::newton_h},
     {"newton_error", &LimitRow::newton_error},
     {"newton_error_bound", &LimitRow::newton_error_bound},
     {"observed", &LimitRow::observed},
     {"gap", &LimitRow::gap},
     {"steps_used", &LimitRow::steps_used},
     {"step_defect", &LimitRow::step_defect},
     {"along_least", &LimitRow::along_least},
     {"along_at", &LimitRow::along_at},
     {"along_growing", &LimitRow::along_growing},
     {"along_grows_from", &LimitRow::along_grows_from},
     {"from_start", &LimitRow::from_start},
     {"from_start_stride", &LimitRow::from_start_stride}}};

}  // namespace hmax
