/// Stability regions as figures take them.
#pragma once

#include <string>
#include <vector>

#include "analysis/amplification/region.hpp"
#include "plots/stability.hpp"

namespace hmax {

/// The boundary of a region, in the plane of z = h lambda.
inline RegionShape shape_of(const std::string& label, const std::vector<RegionCurve>& curves) {
  RegionShape shape{.label = label};
  for (const RegionCurve& curve : curves) {
    shape.loops.emplace_back();
    for (const auto z : curve.points) shape.loops.back().push_back({z.real(), z.imag()});
  }
  return shape;
}

}  // namespace hmax
