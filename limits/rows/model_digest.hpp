/// Whether two problems of one name are the same model.
#pragma once

#include <string>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// 16 hexadecimal digits made of the bits of the right-hand side and of its stiff part, at the initial state,
/// at seven states within 10 of it, where numbers of formulas are far from that at five within ten times
/// them, and at eight times: a mesh or a file of formulas that has changed has another digest, unless it is
/// the same function at all of them.
std::string model_digest(const Problem& problem);

}  // namespace hmax
