/// The columns of stored advice: one list for the table, statements and exports.
#pragma once

#include <array>

#include "results/advice_record.hpp"
#include "results/limits/columns.hpp"

namespace hmax {

inline constexpr std::array<Column<AdviceKey, std::string>, 7> advice_key_texts{
    {{"problem", &AdviceKey::problem},
     {"material", &AdviceKey::material},
     {"parameters", &AdviceKey::parameters},
     {"y0", &AdviceKey::y0},
     {"model", &AdviceKey::model},
     {"motion", &AdviceKey::motion},
     {"ranked_by", &AdviceKey::ranked_by}}};

inline constexpr std::array<Column<AdviceKey, double>, 3> advice_key_numbers{
    {{"rate", &AdviceKey::rate}, {"tolerance", &AdviceKey::tolerance}, {"budget_s", &AdviceKey::budget}}};

inline constexpr std::array<Column<AdviceRecord, std::string>, 7> advice_texts{
    {{"method", &AdviceRecord::method},
     {"options", &AdviceRecord::options},
     {"bound", &AdviceRecord::bound},
     {"verdict", &AdviceRecord::verdict},
     {"status", &AdviceRecord::status},
     {"frame_tail_s", &AdviceRecord::frame_tail},
     {"stage", &AdviceRecord::stage}}};

inline constexpr std::array<Column<AdviceRecord, double>, 16> advice_numbers{
    {{"h", &AdviceRecord::h},
     {"steps_per_frame", &AdviceRecord::steps_per_frame},
     {"h_max", &AdviceRecord::h_max},
     {"h_max_observed", &AdviceRecord::h_max_observed},
     {"h_accurate", &AdviceRecord::h_accurate},
     {"error", &AdviceRecord::error},
     {"frame_p50_s", &AdviceRecord::frame_p50},
     {"frame_p99_s", &AdviceRecord::frame_p99},
     {"frame_max_s", &AdviceRecord::frame_max},
     {"first_frame_s", &AdviceRecord::first_frame},
     {"frames", &AdviceRecord::frames},
     {"missed", &AdviceRecord::missed},
     {"newton_per_frame", &AdviceRecord::newton_per_frame},
     {"linear_per_frame", &AdviceRecord::linear_per_frame},
     {"memory_bytes", &AdviceRecord::memory},
     {"stiffening", &AdviceRecord::stiffening}}};

}  // namespace hmax
