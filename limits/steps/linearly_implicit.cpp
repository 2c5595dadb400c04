#include "limits/steps/linearly_implicit.hpp"

#include <tuple>
#include <type_traits>

#include "integrators/implicit/rosenbrock_tableaux.hpp"

namespace hmax {

namespace {

template <class Visit>
void each_method(const Visit& visit) {
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    (visit(std::type_identity<T>{}), ...);
  }(std::type_identity<tableaux::AllRosenbrock>{});
}

}  // namespace

std::vector<std::string_view> linearly_implicit_ids() {
  std::vector<std::string_view> ids;
  each_method([&]<class T>(std::type_identity<T>) { ids.push_back(T::id); });
  return ids;
}

std::optional<LinearlyImplicitMethod> linearly_implicit_method(std::string_view id) {
  std::optional<LinearlyImplicitMethod> found;
  each_method([&]<class T>(std::type_identity<T>) {
    if (T::id == id) found = linearly_implicit(T::tableau);
  });
  return found;
}

}  // namespace hmax
