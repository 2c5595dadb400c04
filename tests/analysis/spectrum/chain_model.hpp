/// A chain of springs as a model, for tests of its spectrum.
#pragma once

#include "analysis/spectrum/linear_model.hpp"
#include "analysis/spectrum/spectrum.hpp"
#include "problems/test_set/spring_chain.hpp"

namespace hmax {

inline LinearModel chain_model(const SpringChainParameters& p) {
  const SpringChain<double> chain(p);
  return linearise(chain, 0, chain.y0());
}

}  // namespace hmax
