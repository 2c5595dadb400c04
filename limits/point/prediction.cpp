#include "limits/point/prediction.hpp"

namespace hmax {

std::string_view name_of(Bound bound) {
  switch (bound) {
    case Bound::stability:
      return "stability";
    case Bound::accuracy:
      return "accuracy";
    case Bound::newton:
      return "newton";
    case Bound::model:
      return "model";
    case Bound::every_step:
      return "every_step";
    case Bound::error_control:
      return "error_control";
    case Bound::unknown:
      break;
  }
  return "unknown";
}

}  // namespace hmax
