/// Limits of a structure whose rows are dealt out, beside what runs of its steps show.
#pragma once

#include <functional>
#include <string>

#include "catalogue/methods/method.hpp"
#include "limits/distributed/distributed_engine.hpp"
#include "limits/point/operating_point.hpp"
#include "limits/point/prediction.hpp"

namespace hmax {

/// Why a method cannot step rows that are dealt out; empty where it can. Each process makes steps of its rows
/// with the code of the method; accelerations and equations are those of all (core/structure_operator.hpp),
/// and a norm is the largest of those of the processes (`largest_of_all`, integrators/system.hpp).
std::string why_not_stepped(const Method& method);

/// The user ended the runs; thrown on all processes.
struct RunsInterrupted {};

/// As verify() (limits/verification.hpp): integrates with the code of the method on both sides of the
/// prediction, from the fastest mode, and puts what it shows into the row; a `note` where there are no such
/// runs. Called by all processes together, with the same row.
/// @param near         linearised() of the ends of the model
/// @param interrupted  asked at every step
/// @throws RunsInterrupted, std::exception
void verify(Prediction& row, const Method& method, const Linearised& near, DistributedModel& model,
            const std::function<bool()>& interrupted);

}  // namespace hmax
