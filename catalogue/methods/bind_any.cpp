#include "catalogue/methods/bind_explicit_rk.hpp"

namespace hmax {

template Runner bind_explicit_rk(std::size_t, const AnySystem&, const Eigen::VectorXd&);
template Runner bind_explicit_rk(const RuntimeTableau&, const AnySystem&, const Eigen::VectorXd&);

decltype(Runner::end_state_extended) extend_explicit_rk(std::size_t method, const Problem& problem) {
  if (!problem.extended) return {};
  return [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    using Extend = decltype(Runner::end_state_extended) (*)(const Problem&);
    constexpr std::array<Extend, sizeof...(T)> table{
        [](const Problem& p) -> decltype(Runner::end_state_extended) {
          return extended_run(Rk<T, ExtendedSystem::State>{}, *p.extended, p.y0);
        }...};
    return table.at(method)(problem);
  }(std::type_identity<tableaux::All>{});
}

decltype(Runner::end_state_extended) extend_explicit_rk(const RuntimeTableau& tableau,
                                                        const Problem& problem) {
  if (!problem.extended) return {};
  return extended_run(ExplicitRk<RuntimeTableau, ExtendedSystem::State>(tableau), *problem.extended,
                      problem.y0);
}

}  // namespace hmax
